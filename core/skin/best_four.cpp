// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/best_four.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {
// Below this a weight is noise of the solve, in 1/65535.
constexpr int kLeastWeight = 7;

// Scales the sum to exactly kFullWeight; what rounding down leaves goes to the largest.
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

void BestFour::offer(const std::vector<std::int64_t>& place, const std::vector<float>& values, int lanes, int lane, int bone) {
  parallel_for(std::ssize(place), 16384, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const float value = values[i * lanes + lane];
      const int whole = static_cast<int>(std::lround(std::clamp(value, 0.0f, 1.0f) * kFullWeight));
      Influence& best = best_[place[i]];
      // Of equal weights the lower bone goes first, so that the order of offers does not show.
      auto after = [&](int k) { return whole > best.weight[k] || (whole == best.weight[k] && bone < best.bone[k]); };
      if (whole < kLeastWeight || !after(3)) continue;
      int k = 3;
      for (; k > 0 && after(k - 1); --k) {
        best.bone[k] = best.bone[k - 1];
        best.weight[k] = best.weight[k - 1];
      }
      best.bone[k] = static_cast<std::uint16_t>(bone);
      best.weight[k] = static_cast<std::uint16_t>(whole);
    }
  });
}

SkinWeights BestFour::weights(std::vector<std::string> bone_names, const TissueVoxels& tissue) const {
  SkinWeights weights(std::move(bone_names), tissue);
  for (std::int64_t b = 0; b < std::ssize(tissue.bricks()); ++b) {
    const auto& brick = tissue.bricks()[b];
    SkinWeights::Chunk chunk(best_.begin() + brick.first, best_.begin() + brick.first + brick.count());
    for (Influence& influence : chunk) influence = normalized(influence);
    weights.set_chunk(b, std::move(chunk));
  }
  return weights;
}

}  // namespace limber
