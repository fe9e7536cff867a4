// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/transfer_to_volume.h"

namespace limber {

namespace {

// Returns the influence with its bone indices replaced by `to`, or nothing if none of its bones is left. The weights
// still sum exactly, and they change only where a bone was removed.
std::optional<Influence> carried(const Influence& influence, const std::vector<int>& to) {
  std::vector<std::pair<int, double>> weights;
  for (int i = 0; i < 4; ++i) {
    if (!influence.weight[i]) continue;
    const int bone = to.at(influence.bone[i]);
    if (bone < 0) continue;
    bool found = false;
    for (auto& [other, weight] : weights)
      if (other == bone) {
        weight += influence.weight[i];
        found = true;
      }
    if (!found) weights.emplace_back(bone, influence.weight[i]);
  }
  if (weights.empty()) return std::nullopt;
  return quantize(weights);
}

}  // namespace

std::optional<SkinWeights> carried(const SkinWeights& weights, const std::vector<int>& to,
                                   const std::vector<std::string>& names) {
  bool same = true;
  for (std::size_t bone = 0; bone < to.size(); ++bone) same = same && to[bone] == static_cast<int>(bone);
  std::vector<std::shared_ptr<const SkinWeights::Chunk>> chunks;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    if (same) {
      chunks.push_back(weights.shared_chunk(brick));
      continue;
    }
    SkinWeights::Influences made;
    made.reserve(weights.chunk(brick).size());
    for (const Influence& influence : weights.chunk(brick)) {
      const auto next = carried(influence, to);
      if (!next) return std::nullopt;
      made.push_back(*next);
    }
    chunks.push_back(std::make_shared<const SkinWeights::Chunk>(made));
  }
  return SkinWeights(names, std::move(chunks));
}

}  // namespace limber
