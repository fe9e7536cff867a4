// SPDX-License-Identifier: AGPL-3.0-or-later
// The voxels that are not air, as a list. Weights, solves and painting live on this list, never on the dense grid:
// the paper's arm has 7 289 600 voxels and 646 912 of tissue.
//
// Brick order: the grid is cut into bricks of 8^3 voxels; bricks run x fastest, and inside a brick voxels run x
// fastest. A brick knows its tissue by a 512-bit mask, so the list needs one bit a voxel and finds a voxel's place by
// counting bits.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

class TissueVoxels {
 public:
  static constexpr int kBrick = 8;

  struct Brick {
    glm::ivec3 corner;                     // lowest voxel
    std::int64_t first;                    // place of its first tissue voxel in the list
    std::array<std::uint64_t, 8> mask;     // one word a z slice: bit x + 8 y
    std::array<std::uint16_t, 8> below{};  // tissue voxels in the slices before each
    int count() const {
      int bits = 0;
      for (auto word : mask) bits += std::popcount(word);
      return bits;
    }
  };

  TissueVoxels() = default;
  explicit TissueVoxels(const LabelVolume& volume);

  std::int64_t size() const { return size_; }
  glm::ivec3 grid_size() const { return grid_size_; }
  glm::ivec3 brick_grid() const { return brick_grid_; }
  const std::vector<Brick>& bricks() const { return bricks_; }  // only bricks with tissue, in brick order
  // Position in bricks() of the brick that holds voxel v, -1 if it has no tissue.
  int brick_at(const glm::ivec3& v) const {
    return brick_of_[(v.x >> 3) +
                     std::int64_t{brick_grid_.x} * ((v.y >> 3) + std::int64_t{brick_grid_.y} * (v.z >> 3))];
  }

  // Place of voxel v in the list, -1 for air. v must lie inside the grid.
  std::int64_t index_of(const glm::ivec3& v) const {
    const int brick = brick_at(v);
    if (brick < 0) return -1;
    return index_in(bricks_[brick], v & 7);
  }
  // Of a voxel that lies `in` a brick, 0 .. 7 along each axis.
  static std::int64_t index_in(const Brick& brick, const glm::ivec3& in) {
    const int bit = in.x + 8 * in.y;
    if (!(brick.mask[in.z] >> bit & 1)) return -1;
    return brick.first + brick.below[in.z] + bits_in(brick.mask[in.z] & ((std::uint64_t{1} << bit) - 1));
  }
  // Whether voxel v, which must lie inside the grid, is tissue.
  bool holds(const glm::ivec3& v) const {
    const int brick = brick_at(v);
    return brick >= 0 && (bricks_[brick].mask[v.z & 7] >> ((v.x & 7) + 8 * (v.y & 7)) & 1);
  }

  RowSet rows() const;  // that hold tissue

  // Faces across which tissue does not hang together; nullptr where none is known.
  const Seams* seams() const { return seams_.get(); }
  const std::shared_ptr<const Seams>& shared_seams() const { return seams_; }
  void set_seams(std::shared_ptr<const Seams> seams) { seams_ = seams && !seams->empty() ? std::move(seams) : nullptr; }

  // body(place, voxel) for every tissue voxel of bricks [first_brick, end_brick), in list order.
  template <class Body>
  void for_each(std::int64_t first_brick, std::int64_t end_brick, const Body& body) const {
    for (std::int64_t b = first_brick; b < end_brick; ++b) {
      const Brick& brick = bricks_[b];
      std::int64_t place = brick.first;
      for (int z = 0; z < 8; ++z)
        for (std::uint64_t word = brick.mask[z]; word; word &= word - 1) {
          const int bit = std::countr_zero(word);
          body(place++, brick.corner + glm::ivec3(bit & 7, bit >> 3, z));
        }
    }
  }
  template <class Body>
  void for_each(const Body& body) const {
    for_each(0, std::ssize(bricks_), body);
  }

 private:
  // Sums of 2, 4 and 8 neighbouring bits, then of the bytes: std::popcount is a call where the processor's own
  // instruction may not be assumed.
  static int bits_in(std::uint64_t word) {
    word -= word >> 1 & 0x5555555555555555;
    word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
    word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0f;
    return static_cast<int>(word * 0x0101010101010101 >> 56);
  }

  glm::ivec3 grid_size_{0}, brick_grid_{0};
  std::int64_t size_ = 0;
  std::vector<Brick> bricks_;
  std::shared_ptr<const Seams> seams_;
  std::vector<std::int32_t> brick_of_;
};

}  // namespace limber
