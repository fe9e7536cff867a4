// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/top_four.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {
// A weight below this, in 1/65535, is dropped: it is noise of the solver that computes weights.
constexpr int kLeastWeight = 7;

// Scales the weights so that their sum is exactly kFullWeight. The weights are rounded down, and the largest one takes
// the remainder.
Influence normalized(Influence influence) {
  std::int64_t sum = 0;
  for (int k = 0; k < 4; ++k) sum += influence.weight[k];
  int left = kFullWeight;
  for (int k = 3; k > 0; --k) {
    const auto whole = static_cast<int>(influence.weight[k] * std::int64_t{kFullWeight} / sum);
    influence.weight[k] = static_cast<std::uint16_t>(whole);
    if (whole == 0) influence.bone[k] = 0;
    left -= whole;
  }
  influence.weight[0] = static_cast<std::uint16_t>(left);
  return influence;
}
}  // namespace

BestFour::Slot& BestFour::grow_to(std::int64_t brick, std::int64_t place, int k) {
  Brick& here = bricks_[brick];
  if (k >= here.used) {
    here.used = k + 1;
    here.slots.resize(here.used * here.count);
  }
  return here.slots[k * here.count + place - tissue_.bricks()[brick].first];
}

void BestFour::offer(std::int64_t brick, std::int64_t place, int bone, float weight) {
  const int whole = static_cast<int>(std::lround(std::clamp(weight, 0.0f, 1.0f) * kFullWeight));
  // Where two weights are equal, the bone with the lower index comes first, so that the order of calls does not matter.
  const auto after = [&](int k) {
    const Slot best = at(brick, place, k);
    return whole > best.weight || (whole == best.weight && bone < best.bone);
  };
  if (whole < kLeastWeight || !after(3)) return;
  int k = 3;
  while (k > 0 && after(k - 1)) --k;
  Slot moved{static_cast<std::uint16_t>(bone), static_cast<std::uint16_t>(whole)};
  for (; k < 4 && moved.weight > 0; ++k) std::swap(moved, grow_to(brick, place, k));
}

float BestFour::weight(std::int64_t brick, std::int64_t place, int bone) const {
  for (int k = 0; k < bricks_[brick].used; ++k)
    if (const Slot slot = at(brick, place, k); slot.bone == bone && slot.weight > 0)
      return static_cast<float>(slot.weight) / kFullWeight;
  return 0;
}

void BestFour::hold(std::int64_t brick, std::int64_t place, int bone) {
  grow_to(brick, place, 0) = {static_cast<std::uint16_t>(bone), kFullWeight};
  for (int k = 1; k < bricks_[brick].used; ++k) grow_to(brick, place, k) = {};
}

void BestFour::hold_all(std::span<const std::uint16_t> bones, std::uint16_t none) {
  parallel_for(std::ssize(bricks_), 64, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick) {
      const auto& here = tissue_.bricks()[brick];
      for (std::int64_t place = here.first; place < here.first + bricks_[brick].count; ++place)
        if (bones[place] != none) hold(brick, place, bones[place]);
    }
  });
}

SkinWeights BestFour::weights(std::vector<std::string> bone_names) {
  std::vector<std::shared_ptr<const SkinWeights::Chunk>> chunks(bricks_.size());
  parallel_for(std::ssize(bricks_), 64, [&](std::int64_t begin, std::int64_t end) {
    SkinWeights::Influences influences;
    for (std::int64_t brick = begin; brick < end; ++brick) {
      influences.assign(bricks_[brick].count, {});
      for (std::int64_t i = 0; i < std::ssize(influences); ++i) {
        for (int k = 0; k < 4; ++k) {
          const Slot slot = at(brick, tissue_.bricks()[brick].first + i, k);
          influences[i].bone[k] = slot.bone;
          influences[i].weight[k] = slot.weight;
        }
        influences[i] = normalized(influences[i]);
      }
      bricks_[brick] = {};
      chunks[brick] = std::make_shared<const SkinWeights::Chunk>(influences);
    }
  });
  return {std::move(bone_names), std::move(chunks)};
}

std::vector<std::string> names_of_bones(const Armature& armature) {
  std::vector<std::string> names;
  for (const Bone& bone : armature.bones) names.push_back(bone.name);
  return names;
}

}  // namespace limber
