// SPDX-License-Identifier: AGPL-3.0-or-later
// Named points of a body, as comma-separated values: a line `name,x,y,z`, then a point a line, mm, LPS.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"

namespace limber {

struct Landmark {
  std::string name;
  glm::dvec3 position{0};  // world, mm
};

// Throws Error naming file and line.
std::vector<Landmark> read_landmarks(const Path& path);
void write_landmarks(const std::vector<Landmark>& landmarks, const Path& path);

}  // namespace limber
