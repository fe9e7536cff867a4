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
  bool contact = false, error_estimate = false;
  std::string quality, mesher, gravity, pressure;
  std::vector<std::string> obstacles;
};

void add_fem_options(CLI::App& command, const std::shared_ptr<FemOptions>& options);

// Returns the name of an option that was given and that only finite elements have; "": none.
std::string given_fem_option(const FemOptions& options);

// Reads the objects of --obstacle. Each is SHAPE[@PLACE][@from=X,Y,Z|@from=around][@force=NEWTON|@force=weight].
//   SHAPE   a file of triangles, or box:X,Y,Z, cylinder:RADIUS,LENGTH, tube:RADIUS,LENGTH, plane:X,Y (mm)
//   PLACE   X,Y,Z to add to the positions, mm, or the twelve numbers of a matrix, row by row: three of the rotation,
//           then the motion, for each axis
// Throws Error for a bad value or file.
std::vector<FemObject> objects_of(const FemOptions& options);

// Returns the acceleration of gravity, m/s2, of --gravity X,Y,Z: the direction down, of which the length does not
// matter.
glm::dvec3 gravity_of(const FemOptions& options);

// Writes the nodes of the skin that objects press, one row each, to a CSV file.
void write_pressure(const std::vector<PressedNode>& pressed, const std::vector<ObjectReport>& objects,
                    const Path& path);

}  // namespace limber::cmd
