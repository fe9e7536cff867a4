// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/corner_weights.h"

#include <algorithm>
#include <bit>

namespace limber {

namespace {

// The number of set bits of each byte value. A table is used because std::popcount may compile to a function call.
constexpr std::array<std::uint8_t, 256> kBitCount = [] {
  std::array<std::uint8_t, 256> count{};
  for (int i = 1; i < 256; ++i) count[i] = static_cast<std::uint8_t>(count[i / 2] + (i & 1));
  return count;
}();

// Return the lowest and the highest voxel, of those that touch the central brick, in the neighbouring brick at the
// offset `step` (-1, 0 or 1 per axis). Along an axis with step -1 both are at 7, with step 1 both are at 0, and with
// step 0 they are at 0 and 7.
glm::ivec3 first_of(const glm::ivec3& step) { return glm::ivec3(glm::lessThan(step, glm::ivec3(0))) * 7; }
glm::ivec3 last_of(const glm::ivec3& step) { return 7 - glm::ivec3(glm::greaterThan(step, glm::ivec3(0))) * 7; }

}  // namespace

CornerWeights::CornerWeights(const TissueVoxels& tissue, const SkinWeights& weights, const std::vector<int>& moves_as,
                             std::int64_t brick)
    : moves_as_(moves_as),
      slot_of_(weights.bones().size(), -1) {
  const glm::ivec3 corner = tissue.bricks()[brick].corner;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const glm::ivec3 step(i, j, k), at = corner + step * TissueVoxels::kBrick;
        if (at.x < 0 || at.y < 0 || at.z < 0 || glm::any(glm::greaterThanEqual(at, tissue.grid_size()))) continue;
        const int neighbour = tissue.brick_at(at);
        if (neighbour >= 0) gather(tissue.bricks()[neighbour], weights.chunk(neighbour), step);
      }
  sum_over_corners();
  order_.resize(bones_.size());
  influences_.resize(bones_.size());
  four_.resize(bones_.size() + 1);  // one more, since at() may write one element beyond the last
  for (size_t s = 0; s < order_.size(); ++s) order_[s] = static_cast<int>(s);
  std::sort(order_.begin(), order_.end(), [&](int a, int b) { return bones_[a] < bones_[b]; });
}

std::span<const BoneWeight> CornerWeights::at(const glm::ivec3& corner) {
  const int here = place(corner);
  BoneWeight* end = influences_.data();
  for (int s : order_)
    if (const std::uint32_t sum = sums_[s * kHaloCount + here]) *end++ = {bones_[s], double(sum)};
  return {influences_.data(), end};
}

CornerWeights::Four CornerWeights::at(const FourIntegers& i, const FourIntegers& j, const FourIntegers& k) {
  const FourIntegers here = i + kHalo * (j + kHalo * k);
  FourIntegers bones{};
  FourWeights* end = four_.data();
  for (const int s : order_) {
    const std::uint32_t* sums = &sums_[s * kHaloCount];
    // A sum is at most eight times kFullWeight, so it also fits a signed integer.
    const FourIntegers sum = {static_cast<int>(sums[here[0]]), static_cast<int>(sums[here[1]]),
                              static_cast<int>(sums[here[2]]), static_cast<int>(sums[here[3]])};
    const FourIntegers follows = sum != 0;
    bones -= follows;
    end->bone = bones_[s];
    end->weight = __builtin_convertvector(sum, FourNumbers);
    end += (follows[0] | follows[1] | follows[2] | follows[3]) != 0;
  }
  return {{four_.data(), end}, bones};
}

void CornerWeights::gather(const TissueVoxels::Brick& brick, const SkinWeights::Chunk& chunk, const glm::ivec3& step) {
  const glm::ivec3 first = first_of(step), last = last_of(step);
  const unsigned columns = (0xffu >> (7 - last.x)) & (0xffu << first.x);
  int at = 0;  // index in the chunk of the first voxel of the current row
  for (int z = 0; z <= last.z; ++z) {
    if (z < first.z) {
      at += std::popcount(brick.mask[z]);
      continue;
    }
    for (int y = 0; y < TissueVoxels::kBrick; ++y) {
      const unsigned row = brick.mask[z] >> (8 * y) & 0xff;
      for (unsigned bits = y >= first.y && y <= last.y ? row & columns : 0; bits; bits &= bits - 1) {
        const glm::ivec3 v = glm::ivec3(std::countr_zero(bits), y, z) + step * TissueVoxels::kBrick + 1;
        add(chunk[at + kBitCount[row & ((bits & -bits) - 1)]], place(v));
      }
      at += kBitCount[row];
    }
  }
}

// Most voxels follow the same bones as the previous voxel, so the slots are looked up only if the bones differ.
void CornerWeights::add(const Influence& influence, int here) {
  if (const auto bones = std::bit_cast<std::uint64_t>(influence.bone); bones != last_bones_) {
    last_bones_ = bones;
    last_slots_.fill(-1);
  }
  for (int i = 0; i < 4 && influence.weight[i]; ++i) {
    if (last_slots_[i] < 0) last_slots_[i] = slot_of(moves_as_[influence.bone[i]]);
    sums_[last_slots_[i] * kHaloCount + here] += influence.weight[i];
  }
}

int CornerWeights::slot_of(int bone) {
  int& slot = slot_of_[bone];
  if (slot < 0) {
    slot = static_cast<int>(bones_.size());
    bones_.push_back(bone);
    sums_.resize(sums_.size() + kHaloCount, 0);
  }
  return slot;
}

// Computes sums over 2 x 2 x 2 voxels in place, axis by axis. The results in the last column, row and slice are
// meaningless and are never read.
void CornerWeights::sum_over_corners() {
  for (size_t slot = 0; slot < bones_.size(); ++slot) {
    std::uint32_t* sum = &sums_[slot * kHaloCount];
    for (int stride : {1, kHalo, kHalo * kHalo})
      for (int i = 0; i + stride < kHaloCount; ++i) sum[i] += sum[i + stride];
  }
}

}  // namespace limber
