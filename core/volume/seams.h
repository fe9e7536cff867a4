// SPDX-License-Identifier: AGPL-3.0-or-later
// A seam is a set of voxel faces at which tissue touches but is not connected. Where a hand lies on a hip, skin touches
// skin, or in a coarse scan flesh touches flesh. A seam separates hand and hip without removing a voxel: heat and
// geodesic paths do not cross the seam, and in the posed body its two sides are two surfaces.
//
// A face is identified by the lower of its two voxels and by the axis perpendicular to the face.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

namespace limber {

class Seams {
 public:
  // Creates an empty set for a volume of `grid_size` voxels.
  explicit Seams(const glm::ivec3& grid_size);

  glm::ivec3 grid_size() const { return grid_size_; }
  // Add the face to the set of cut faces (cut) or remove it from the set (join). The two voxels of the face, `lower`
  // and its upper neighbour along `axis`, must lie inside the grid.
  void cut(const glm::ivec3& lower, int axis);
  void join(const glm::ivec3& lower, int axis);
  bool is_cut(const glm::ivec3& lower, int axis) const {
    const std::int32_t brick = brick_of_[cell_of(lower)];
    return brick >= 0 && (bricks_[brick][axis][lower.z & 7] >> ((lower.x & 7) + 8 * (lower.y & 7)) & 1);
  }
  // Returns whether the face of `voxel` in a direction is cut. The directions 0 to 5 are towards lower x, higher x,
  // lower y, higher y, lower z and higher z. The neighbour in that direction may lie outside the grid.
  bool is_cut_towards(const glm::ivec3& voxel, int direction) const {
    glm::ivec3 lower = voxel;
    if (!(direction & 1) && --lower[direction >> 1] < 0) return false;
    return is_cut(lower, direction >> 1);
  }
  bool touches(const glm::ivec3& voxel) const;  // returns true if any of the voxel's six faces is cut
  // Returns true if any face is cut in the brick (8^3 voxels) whose lowest voxel is `corner`, or in one of its 26
  // neighbouring bricks.
  bool is_near_brick(const glm::ivec3& corner) const;

  std::int64_t size() const { return size_; }  // number of cut faces
  std::int64_t heap_bytes() const {
    return static_cast<std::int64_t>(brick_of_.capacity() * sizeof(std::int32_t) + bricks_.capacity() * sizeof(Brick));
  }
  bool empty() const { return size_ == 0; }
  bool operator==(const Seams& other) const;

  // Calls body(lower voxel, axis) for every cut face, brick by brick.
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
  // Bit x + 8 y of [axis][z] is set if the face of voxel (x, y, z) of the brick towards the higher end of `axis` is
  // cut.
  using Brick = std::array<std::array<std::uint64_t, 8>, 3>;

  std::int64_t cell_of(const glm::ivec3& v) const {
    return (v.x >> 3) + std::int64_t{brick_grid_.x} * ((v.y >> 3) + std::int64_t{brick_grid_.y} * (v.z >> 3));
  }

  glm::ivec3 grid_size_, brick_grid_;
  std::vector<std::int32_t> brick_of_;  // index in bricks_ of each brick of the grid; -1: no face is cut in it
  std::vector<Brick> bricks_;
  std::int64_t size_ = 0;
};

}  // namespace limber
