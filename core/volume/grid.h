// SPDX-License-Identifier: AGPL-3.0-or-later
// A regular grid of voxels in the world. The world is LPS (x to the patient's left, y to the back, z to the head), in
// millimetres. The *centre* of voxel (0,0,0) lies at `origin`. The columns of `direction` are the unit vectors along
// the voxel axes x, y and z, and may form a left-handed system. Voxels are stored x fastest.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace limber {

struct Grid {
  glm::ivec3 size{0};
  glm::dvec3 spacing{1};
  glm::dvec3 origin{0};
  glm::dmat3 direction{1};

  bool operator==(const Grid&) const = default;

  std::int64_t voxel_count() const { return std::int64_t{size.x} * size.y * size.z; }
  double voxel_volume() const { return spacing.x * spacing.y * spacing.z; }  // mm3
  bool contains(const glm::ivec3& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size.x && v.y < size.y && v.z < size.z;
  }
  std::int64_t index(const glm::ivec3& v) const {
    return v.x + std::int64_t{size.x} * (v.y + std::int64_t{size.y} * v.z);
  }
};

// The affine transform p' = linear p + offset.
struct AffineTransform {
  glm::dmat3 linear{1};
  glm::dvec3 offset{0};
};
inline glm::dvec3 operator*(const AffineTransform& t, const glm::dvec3& p) { return t.linear * p + t.offset; }

// Returns the transform from voxel coordinates (voxel centres are whole numbers) to world points in mm.
inline AffineTransform world_from_voxel(const Grid& grid) {
  return {glm::dmat3(grid.direction[0] * grid.spacing.x, grid.direction[1] * grid.spacing.y,
                     grid.direction[2] * grid.spacing.z),
          grid.origin};
}
inline AffineTransform voxel_from_world(const Grid& grid) {
  const glm::dmat3 back = glm::inverse(world_from_voxel(grid).linear);
  return {back, -(back * grid.origin)};
}

}  // namespace limber
