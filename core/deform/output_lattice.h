// SPDX-License-Identifier: AGPL-3.0-or-later
// The lattice of output voxels, and points on it in fixed point (lattice.h).
#pragma once

#include <glm/glm.hpp>

namespace limber {

constexpr int kFixedOne = 65536;  // units of fixed point per output voxel
using FixedPoint = glm::ivec3;    // coordinates in units of 1/65536 output voxel

// A pose that moves a point further than this from the base is refused; in output voxels. Fixed point allows 32 768.
constexpr double kFurthestPosed = 32000;

// The transform from rest voxel coordinates to the output lattice: output = (rest + 0.5) * ratio - 0.5 - base.
struct OutputLattice {
  glm::dvec3 ratio{1};  // rest spacing / output spacing; exactly 1 where they are equal
  glm::ivec3 base{0};

  glm::dvec3 from_rest(const glm::dvec3& rest) const { return (rest + 0.5) * ratio - 0.5 - glm::dvec3(base); }
  glm::dvec3 to_rest(const glm::dvec3& output) const { return (output + glm::dvec3(base) + 0.5) / ratio - 0.5; }
};

}  // namespace limber
