// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes named points of a body as comma-separated values: a title line `name,x,y,z`, then one point per
// line. Coordinates are in mm, world axes LPS.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"

namespace limber {

struct Landmark {
  std::string name;
  glm::dvec3 position{0};  // position of the landmark in the world, mm
};

// Reads landmarks. Throws an Error that names the file and the line.
std::vector<Landmark> read_landmarks(const Path& path);
void write_landmarks(const std::vector<Landmark>& landmarks, const Path& path);

}  // namespace limber
