// SPDX-License-Identifier: AGPL-3.0-or-later
// One brick of tissue (8^3 voxels) and the layer of voxels around it, as a dense block. Heat flows through voxel faces
// only, so a solver step on a brick reads no other voxels.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

// Stored instead of a bone's index for a soft voxel: a voxel whose temperature no bone fixes.
constexpr std::uint16_t kSoft = 0xFFFF;

struct BrickWindow {
  // The data from which a window is read. The referenced objects must outlive the window.
  struct Source {
    const LabelVolume& volume;
    const TissueVoxels& tissue;
    const ZeroedVector<std::uint16_t>& held_by;  // bone that fixes each tissue voxel's temperature; kSoft: none
    const std::vector<float>& conductivity;      // conductivity of the tissue of each label, above 0
  };
  // Index offset in the arrays below to the neighbour towards -x, +x, -y, +y, -z, +z.
  static constexpr int kTo[6] = {-1, 1, -10, 10, -100, 100};

  std::array<std::int32_t, 1000> place;    // index in the list of tissue voxels; -1: air
  std::array<float, 1000> soft;            // conductivity of each soft voxel; 0 for other voxels
  std::array<std::uint64_t, 8> soft_bits;  // the brick's soft voxels, one word per z slice: bit x + 8 y
  std::array<int, 6> beside;               // index of the neighbouring brick in each direction; -1: none
  const Seams* seams = nullptr;            // null: no seam is near this brick

  // Returns the index of voxel v in the arrays; v is relative to the brick's lowest corner, [-1, 8] along each axis.
  static int at(const glm::ivec3& v) { return (v.x + 1) + 10 * (v.y + 1) + 100 * (v.z + 1); }

  // Returns true if a seam cuts the face of a voxel in the given direction. `voxel` is in coordinates of the volume.
  bool is_cut(const glm::ivec3& voxel, int direction) const { return seams && seams->is_cut_towards(voxel, direction); }

  // Reads a brick and the layer around it into the window. Voxels at the window's edges and corners are not read and
  // count as air.
  void look(const Source& from, std::int64_t brick) {
    const auto& here = from.tissue.bricks()[brick];
    seams = from.tissue.seams();
    if (seams && !seams->is_near_brick(here.corner)) seams = nullptr;
    place.fill(-1);
    soft.fill(0);
    for (int z = 0; z < TissueVoxels::kBrick; ++z) soft_bits[z] = look_at(from, here, z, kAll, {0, 0, z});
    for (int direction = 0; direction < 6; ++direction) look_beside(from, here.corner, direction);
  }

  // Calls body(voxel, index) for every soft voxel of the brick, in the order of the list of tissue voxels. `voxel` is
  // relative to the brick's lowest corner, `index` is its index in the arrays.
  template <class Body>
  void for_soft(const Body& body) const {
    for (int z = 0; z < TissueVoxels::kBrick; ++z)
      for (std::uint64_t bits = soft_bits[z]; bits; bits &= bits - 1) {
        const glm::ivec3 v(std::countr_zero(bits) & 7, std::countr_zero(bits) >> 3, z);
        body(v, at(v));
      }
  }

 private:
  static constexpr std::uint64_t kAll = ~std::uint64_t{0};

  // Reads those voxels of slice z of a brick whose bits (x + 8 y) are set in `which`. Returns the bits of the soft
  // voxels among them.
  //   to  position of the voxel of bit 0 in the window, relative to the lowest corner of the window's brick
  std::uint64_t look_at(const Source& from, const TissueVoxels::Brick& brick, int z, std::uint64_t which,
                        const glm::ivec3& to) {
    if (!(brick.mask[z] & which)) return 0;
    const glm::ivec3 corner = brick.corner + glm::ivec3(0, 0, z);
    const Label* label = &from.volume.voxels[from.volume.grid.index(corner)];
    const std::int64_t row = from.volume.grid.size.x;
    std::int64_t next = brick.first + brick.below[z];
    std::uint64_t soft_ones = 0;
    for (std::uint64_t bits = brick.mask[z] & which; bits; bits &= bits - 1, ++next) {
      const int bit = std::countr_zero(bits), x = bit & 7, y = bit >> 3;
      if (which != kAll) next = TissueVoxels::index_in(brick, {x, y, z});
      const int its = at(to) + x + 10 * y;
      place[its] = static_cast<std::int32_t>(next);
      if (from.held_by[next] != kSoft) continue;
      soft[its] = from.conductivity[label[x + y * row]];
      soft_ones |= std::uint64_t{1} << bit;
    }
    return soft_ones;
  }

  // Reads the layer of voxels in the neighbouring brick in a direction.
  void look_beside(const Source& from, const glm::ivec3& corner, int direction) {
    // Bits of a slice's voxels with the lowest x, and of those with the lowest y.
    constexpr std::uint64_t kLowest[2] = {0x0101010101010101, 0xff};
    const int axis = direction >> 1, last = TissueVoxels::kBrick - 1;
    const bool is_higher = direction & 1;
    glm::ivec3 to(0);
    to[axis] = is_higher ? TissueVoxels::kBrick : -TissueVoxels::kBrick;
    beside[direction] = from.volume.grid.contains(corner + to) ? from.tissue.brick_at(corner + to) : -1;
    if (beside[direction] < 0) return;
    const auto& there = from.tissue.bricks()[beside[direction]];
    if (axis == 2) {
      look_at(from, there, is_higher ? 0 : last, kAll, {0, 0, is_higher ? TissueVoxels::kBrick : -1});
      return;
    }
    const std::uint64_t which = is_higher ? kLowest[axis] : kLowest[axis] << (axis == 0 ? last : last * 8);
    for (int z = 0; z <= last; ++z) look_at(from, there, z, which, to + glm::ivec3(0, 0, z));
  }
};

}  // namespace limber
