// SPDX-License-Identifier: AGPL-3.0-or-later
// The options of finite elements: contact, quality, mesher, and the rigid objects and the gravity that act on the body.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/resample/fem.h"

namespace limber::cmd {

struct FemOptions {
  bool contact = false, slide = false, error_estimate = false;
  std::string quality, mesher, gravity, pressure;
  std::vector<std::string> obstacles;
};

void add_fem_options(CLI::App& command, const std::shared_ptr<FemOptions>& options);

// Returns the name of an option that the user gave and that only finite elements use; "" if there is none.
std::string given_fem_option(const FemOptions& options);

// Reads the objects of --obstacle. Each is SHAPE[@PLACE][@from=X,Y,Z|@from=around][@force=NEWTON|@force=weight].
//   SHAPE   a file of triangles, or box:X,Y,Z, cylinder:RADIUS,LENGTH, tube:RADIUS,LENGTH, plane:X,Y (mm)
//   PLACE   X,Y,Z: a translation, mm; or twelve numbers: the rows of a 3 x 4 matrix, each with three numbers of the
//           rotation and one of the translation
// Throws Error for a bad value or file.
std::vector<FemObject> objects_of(const FemOptions& options);

// Returns the acceleration of standard gravity, m/s2, in the direction X,Y,Z of the option --gravity, which may have
// any length. Zero without the option.
glm::dvec3 gravity_of(const FemOptions& options);

// Writes the skin nodes on which objects press to a CSV file, one row for each node.
void write_pressure(const std::vector<PressedNode>& pressed, const std::vector<ObjectReport>& objects,
                    const Path& path);

}  // namespace limber::cmd
