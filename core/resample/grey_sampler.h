// SPDX-License-Identifier: AGPL-3.0-or-later
// Samples the grey values of a volume at any point in world coordinates, mm.
#pragma once

#include "core/volume_io/volume_io.h"

namespace limber {

// Interpolates grey values trilinearly between voxel centres; outside the grid it returns the nearest voxel's value.
class GreySampler {
 public:
  explicit GreySampler(const GreyVolume& grey) : grey_(grey), voxel_from_world_(voxel_from_world(grey.grid)) {}

  float operator()(const glm::dvec3& world) const {
    const glm::dvec3 last(grey_.grid.size - 1);
    const glm::dvec3 p = glm::clamp(voxel_from_world_ * world, glm::dvec3(0), last);
    const glm::ivec3 low = glm::min(glm::ivec3(p), glm::max(grey_.grid.size - 2, glm::ivec3(0)));
    const glm::dvec3 f = p - glm::dvec3(low);
    double value = 0;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 step(k & 1, k >> 1 & 1, k >> 2);
      const double share = (step.x ? f.x : 1 - f.x) * (step.y ? f.y : 1 - f.y) * (step.z ? f.z : 1 - f.z);
      if (share > 0) value += share * grey_.voxels[grey_.grid.index(low + step)];
    }
    return static_cast<float>(value);
  }
  bool covers(const glm::dvec3& world) const {
    const glm::dvec3 p = voxel_from_world_ * world;
    return glm::all(glm::greaterThanEqual(p, glm::dvec3(-0.5))) &&
           glm::all(glm::lessThan(p, glm::dvec3(grey_.grid.size) - 0.5));
  }

 private:
  const GreyVolume& grey_;
  AffineTransform voxel_from_world_;
};

}  // namespace limber
