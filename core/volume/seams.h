// SPDX-License-Identifier: AGPL-3.0-or-later
// Where tissue touches without hanging together: a set of voxel faces. A hand that lies on a hip is skin beside skin,
// and in a coarse scan flesh beside flesh. A seam says that the two are not one, and costs no voxel: heat and geodesic
// ways do not cross it, and when the body is posed its two sides become two surfaces.
//
// A face is named by the lower of its two voxels and the axis that it lies across.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

class Seams {
 public:
  //   grid_size  voxels of the volume
  explicit Seams(const glm::ivec3& grid_size);

  glm::ivec3 grid_size() const { return grid_size_; }
  // `lower` must lie inside the grid, and so must the voxel above it.
  void cut(const glm::ivec3& lower, int axis);
  void join(const glm::ivec3& lower, int axis);
  bool is_cut(const glm::ivec3& lower, int axis) const {
    const std::int32_t brick = brick_of_[cell_of(lower)];
    return brick >= 0 && (bricks_[brick][axis][lower.z & 7] >> ((lower.x & 7) + 8 * (lower.y & 7)) & 1);
  }
  // Whether the face of `voxel` in one of six directions is cut: 0 towards lower x, 1 towards higher x, 2 and 3 along
  // y, 4 and 5 along z. The voxel there may lie outside the grid.
  bool is_cut_towards(const glm::ivec3& voxel, int direction) const {
    glm::ivec3 lower = voxel;
    if (!(direction & 1) && --lower[direction >> 1] < 0) return false;
    return is_cut(lower, direction >> 1);
  }
  bool touches(const glm::ivec3& voxel) const;  // whether any of the voxel's faces is cut
  // Whether a face is cut within the brick of 8^3 voxels whose lowest is `corner`, or within one of the 26 around it.
  bool is_near_brick(const glm::ivec3& corner) const;

  std::int64_t size() const { return size_; }  // faces
  std::int64_t heap_bytes() const {
    return static_cast<std::int64_t>(brick_of_.capacity() * sizeof(std::int32_t) + bricks_.capacity() * sizeof(Brick));
  }
  bool empty() const { return size_ == 0; }
  bool operator==(const Seams& other) const;

  // body(lower voxel, axis) for every face, in order of bricks.
  template <class Body>
  void for_each(const Body& body) const {
    for (std::int64_t cell = 0; cell < std::ssize(brick_of_); ++cell) {
      if (brick_of_[cell] < 0) continue;
      const glm::ivec3 corner = 8 * glm::ivec3(cell % brick_grid_.x, cell / brick_grid_.x % brick_grid_.y,
                                               cell / brick_grid_.x / brick_grid_.y);
      for (int axis = 0; axis < 3; ++axis)
        for (int z = 0; z < 8; ++z)
          for (int bit = 0; bit < 64; ++bit)
            if (bricks_[brick_of_[cell]][axis][z] >> bit & 1) body(corner + glm::ivec3(bit & 7, bit >> 3, z), axis);
    }
  }

 private:
  using Brick = std::array<std::array<std::uint64_t, 8>, 3>;  // by axis and slice: bit x + 8 y

  std::int64_t cell_of(const glm::ivec3& v) const {
    return (v.x >> 3) + std::int64_t{brick_grid_.x} * ((v.y >> 3) + std::int64_t{brick_grid_.y} * (v.z >> 3));
  }

  glm::ivec3 grid_size_, brick_grid_;
  std::vector<std::int32_t> brick_of_;  // of the whole grid, -1 where nothing is cut
  std::vector<Brick> bricks_;
  std::int64_t size_ = 0;
};

}  // namespace limber
