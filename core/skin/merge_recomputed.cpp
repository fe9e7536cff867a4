// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/merge_recomputed.h"

#include <stdexcept>

namespace limber {

namespace {

using Target = std::array<std::pair<int, double>, 8>;

// Returns the weights of one voxel after the merge. The chosen bones get their computed weights. The other bones share
// the remaining weight in proportion to their old weights. If they had no old weight, they get their computed weights.
// Unused entries have weight 0.
Target target_of(const Influence& before, const Influence& computed, const BoneSet& chosen) {
  Target target{};
  int count = 0;
  double anew = 0, kept = 0;
  for (int i = 0; i < 4; ++i)
    if (computed.weight[i] && chosen[computed.bone[i]]) {
      target[count++] = {computed.bone[i], double(computed.weight[i])};
      anew += computed.weight[i];
    }
  const auto others = [&](const Influence& from, double scale) {
    for (int i = 0; i < 4; ++i)
      if (from.weight[i] && !chosen[from.bone[i]]) target[count++] = {from.bone[i], scale * from.weight[i]};
  };
  for (int i = 0; i < 4; ++i)
    if (!chosen[before.bone[i]]) kept += before.weight[i];
  if (kept > 0) others(before, (kFullWeight - anew) / kept);
  else others(computed, 1);
  return target;
}

}  // namespace

WeightEdit recomputed(const WeightedBody& body, const SkinWeights& weights, const SkinWeights& computed,
                      const std::vector<int>& bones, const EditScope& scope) {
  if (weights.size() != computed.size() || weights.bones() != computed.bones())
    throw std::logic_error("the recomputed weights belong to another body");
  BoneSet chosen(weights.bones().size(), bones.empty());
  for (const int bone : bones) chosen[bone] = 1;
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t place, const glm::ivec3& voxel) {
                  const int brick = body.tissue.brick_at(voxel);
                  const Influence& made = computed.chunk(brick)[place - body.tissue.bricks()[brick].first];
                  if (made == influence) return WeightChange{};
                  const Target target = target_of(influence, made, chosen);
                  WeightChange change = rules.blend(influence, target, 1);
                  sort_influence(influence);
                  return change;
                });
}

}  // namespace limber
