// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists the voxels that are not air. Weights, solvers and painting work on this list, never on the dense grid: the
// paper's arm has 7 289 600 voxels, of which 646 912 are tissue.
//
// Brick order: the grid is cut into bricks of 8^3 voxels; bricks are stored x fastest, and so are the voxels inside a
// brick. A 512-bit mask per brick marks its tissue, so the list needs one bit per voxel and finds a voxel's index by
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
    glm::ivec3 corner;   // lowest voxel of the brick
    std::int64_t first;  // index of the brick's first tissue voxel in the list of all tissue voxels
    // Marks tissue voxels: one word per z slice, in which bit x + 8 y is voxel (x, y).
    std::array<std::uint64_t, 8> mask;
    std::array<std::uint16_t, 8> below{};  // number of tissue voxels in the slices below each slice
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
  // Returns the index in bricks() of the brick that holds voxel v, -1 if that brick has no tissue.
  int brick_at(const glm::ivec3& v) const {
    return brick_of_[(v.x >> 3) +
                     std::int64_t{brick_grid_.x} * ((v.y >> 3) + std::int64_t{brick_grid_.y} * (v.z >> 3))];
  }

  // Returns the list index of voxel v, -1 for air. v must lie inside the grid.
  std::int64_t index_of(const glm::ivec3& v) const {
    const int brick = brick_at(v);
    if (brick < 0) return -1;
    return index_in(bricks_[brick], v & 7);
  }
  // Returns the list index of the voxel at position `in` of the brick (0 .. 7 along each axis), -1 for air.
  static std::int64_t index_in(const Brick& brick, const glm::ivec3& in) {
    const int bit = in.x + 8 * in.y;
    if (!(brick.mask[in.z] >> bit & 1)) return -1;
    return brick.first + brick.below[in.z] + bits_in(brick.mask[in.z] & ((std::uint64_t{1} << bit) - 1));
  }
  // Returns whether voxel v, which must lie inside the grid, is tissue.
  bool holds(const glm::ivec3& v) const {
    const int brick = brick_at(v);
    return brick >= 0 && (bricks_[brick].mask[v.z & 7] >> ((v.x & 7) + 8 * (v.y & 7)) & 1);
  }

  RowSet rows() const;  // returns the voxel rows that contain tissue

  // Returns the seams: voxel faces at which touching tissue is not connected; nullptr when there are none.
  const Seams* seams() const { return seams_.get(); }
  const std::shared_ptr<const Seams>& shared_seams() const { return seams_; }
  void set_seams(std::shared_ptr<const Seams> seams) { seams_ = seams && !seams->empty() ? std::move(seams) : nullptr; }

  // Calls body(list index, voxel) for every tissue voxel of bricks [first_brick, end_brick), in list order.
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
  // Calls body(list index, voxel) for the tissue voxels of one brick whose labels are in the set, in list order.
  template <class Body>
  void for_each_of(std::int64_t brick, const LabelVolume& volume, const LabelSet& labels, const Body& body) const {
    const auto& [corner, first, mask, below] = bricks_[brick];
    for (int z = 0; z < 8; ++z) {
      if (!mask[z]) continue;
      const Label* slice = &volume.voxels[volume.grid.index(corner + glm::ivec3(0, 0, z))];
      std::int64_t place = first + below[z];
      for (std::uint64_t word = mask[z]; word; word &= word - 1, ++place)
        if (const int bit = std::countr_zero(word); labels[slice[(bit & 7) + (bit >> 3) * volume.grid.size.x]])
          body(place, corner + glm::ivec3(bit & 7, bit >> 3, z));
    }
  }
  template <class Body>
  void for_each(const Body& body) const {
    for_each(0, std::ssize(bricks_), body);
  }

 private:
  // Returns the number of set bits: adds them up in groups of 2, 4 and 8 bits, then adds the bytes. std::popcount would
  // be a function call where the compiler may not use the processor's instruction for it.
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
