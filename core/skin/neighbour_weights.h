// SPDX-License-Identifier: AGPL-3.0-or-later
// The weights of a brick (8^3 voxels) and of the voxels that touch it, unpacked into one array, so that the neighbours
// of a voxel are found without a search.
#pragma once

#include <array>
#include <bit>

#include "core/skin/skin_weights.h"

namespace limber {

class WeightsAround {
 public:
  // Unpacks the influences of a brick and of the voxels that touch it.
  //   chunk  a function that returns the InfluenceView of the brick with a given index
  template <class ChunkOf>
  WeightsAround(const TissueVoxels& tissue, int brick, const ChunkOf& chunk) {
    const TissueVoxels::Brick& own = tissue.bricks()[brick];
    corner_ = own.corner;
    if (tissue.seams() && tissue.seams()->is_near_brick(corner_)) seams_ = tissue.seams();
    std::array<Influence, kBrick * kBrick * kBrick> all;
    chunk(brick).unpack(std::size_t(own.count()), all.data());
    std::size_t next = 0;
    for (int z = 0; z < kBrick; ++z)
      for (std::uint64_t word = own.mask[z]; word; word &= word - 1) {
        const int bit = std::countr_zero(word);
        around_[place({bit & 7, bit >> 3, z})] = all[next++];
      }
    for (int d = 0; d < 6; ++d) {
      const int axis = d >> 1, step = d & 1 ? kBrick : -kBrick;
      glm::ivec3 shift(0);
      shift[axis] = step;
      const glm::ivec3 corner = own.corner + shift;
      if (corner[axis] < 0 || corner[axis] >= tissue.grid_size()[axis]) continue;
      const int beside = tissue.brick_at(corner);
      if (beside < 0) continue;
      // Only one layer of the neighbouring brick is needed: the voxels that touch this brick.
      const int layer = d & 1 ? 0 : kBrick - 1;
      Mask touching{};
      for (int z = 0; z < kBrick; ++z)
        touching[z] = tissue.bricks()[beside].mask[z] & (axis == 0    ? std::uint64_t{0x0101010101010101u} << layer
                                                         : axis == 1  ? std::uint64_t{0xff} << (kBrick * layer)
                                                         : z == layer ? ~std::uint64_t{0}
                                                                      : 0);
      copy(tissue.bricks()[beside], chunk(beside), shift, touching);
    }
  }

  // Finds the influences of a voxel's face neighbours, up to six. Leaves out air and neighbours across a seam, which is
  // a cut between touching tissue. Returns how many were found.
  //   cell  the voxel's position in the brick, [0, 7] along each axis
  int beside(const glm::ivec3& cell, std::array<Influence, 6>& found) const {
    const Influence* here = &around_[place(cell)];
    int count = 0, direction = 0;
    for (const std::ptrdiff_t step : {-1, 1, -kSide, kSide, -kSide * kSide, kSide * kSide}) {
      found[count] = here[step];
      const bool is_beyond = seams_ && seams_->is_cut_towards(corner_ + cell, direction);
      count += is_tissue(found[count]) && !is_beyond;
      ++direction;
    }
    return count;
  }

 private:
  static constexpr int kBrick = TissueVoxels::kBrick, kSide = kBrick + 2;
  using Mask = std::array<std::uint64_t, kBrick>;

  static int place(const glm::ivec3& cell) { return cell.x + 1 + kSide * (cell.y + 1 + kSide * (cell.z + 1)); }
  static bool is_tissue(const Influence& influence) { return std::bit_cast<std::uint64_t>(influence.weight) != 0; }

  // Copies the influences of those voxels of a brick that are in `wanted`. `shift` is the brick's offset from the
  // middle brick, in voxels.
  void copy(const TissueVoxels::Brick& brick, const InfluenceView& influences, const glm::ivec3& shift,
            const Mask& wanted) {
    std::size_t before = 0;  // number of tissue voxels in the brick's lower slices
    for (int z = 0; z < kBrick; ++z) {
      const std::uint64_t all = brick.mask[z];
      const bool whole = wanted[z] == all;
      std::size_t next = before;
      for (std::uint64_t word = wanted[z]; word; word &= word - 1, ++next) {
        const int bit = std::countr_zero(word);
        const std::size_t at =
            whole ? next : before + std::size_t(std::popcount(all & ((std::uint64_t{1} << bit) - 1)));
        around_[place(glm::ivec3(bit & 7, bit >> 3, z) + shift)] = influences[at];
      }
      before = whole ? next : before + std::size_t(std::popcount(all));
    }
  }

  glm::ivec3 corner_{0};          // lowest corner of the brick, in voxels
  const Seams* seams_ = nullptr;  // null: no seam is near this brick
  // Influences of the brick and its neighbours; all weights are 0 where there is no tissue.
  std::array<Influence, kSide * kSide * kSide> around_{};
};

// A weighted sum of the influences of several voxels, as pairs of bone and weight.
using WeightSum = std::vector<std::pair<int, double>>;

inline void add_to(WeightSum& sum, const Influence& influence, double factor) {
  for (int i = 0; i < 4; ++i) {
    if (influence.weight[i] == 0) continue;
    const int bone = influence.bone[i];
    std::size_t k = 0;
    while (k < sum.size() && sum[k].first != bone) ++k;
    if (k < sum.size()) sum[k].second += factor * influence.weight[i];
    else sum.emplace_back(bone, factor * influence.weight[i]);
  }
}

}  // namespace limber
