// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/influence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace limber {

Influence rigid_influence(int bone) {
  Influence influence;
  influence.bone[0] = static_cast<std::uint16_t>(bone);
  influence.weight[0] = kFullWeight;
  return influence;
}

Influence quantize(const std::vector<std::pair<int, double>>& weights) {
  // Selects the four largest weights. Where two weights are equal, the bone with the lower index comes first, so that
  // the order of the input does not matter.
  std::array<std::pair<int, double>, 4> best;
  int count = 0;
  for (const auto& candidate : weights) {
    if (!(candidate.second > 0)) continue;
    int place = count < 4 ? count : 3;
    auto before = [](const auto& a, const auto& b) {
      return a.second > b.second || (a.second == b.second && a.first < b.first);
    };
    if (count == 4 && !before(candidate, best[3])) continue;
    while (place > 0 && before(candidate, best[place - 1])) {
      best[place] = best[place - 1];
      --place;
    }
    best[place] = candidate;
    count = std::min(count + 1, 4);
  }
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += best[i].second;
  if (count == 0 || !std::isfinite(sum)) throw std::logic_error("quantize: weights sum to zero");

  Influence influence;
  int left = kFullWeight;
  for (int i = count - 1; i > 0; --i) {
    const int whole = static_cast<int>(std::lround(best[i].second / sum * kFullWeight));
    if (whole == 0) continue;
    influence.bone[i] = static_cast<std::uint16_t>(best[i].first);
    influence.weight[i] = static_cast<std::uint16_t>(whole);
    left -= whole;
  }
  influence.bone[0] = static_cast<std::uint16_t>(best[0].first);
  influence.weight[0] = static_cast<std::uint16_t>(left);
  return influence;
}

}  // namespace limber
