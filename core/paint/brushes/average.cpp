// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the brush that moves weights towards their mean over the dab. The mean is weighted by each voxel's cover.
#include <algorithm>

#include "core/paint/brush_rule.h"

namespace limber {

namespace {

class AverageSide final : public BrushSide {
 public:
  explicit AverageSide(const BrushView& view) : view_(view) {}

  // Sums the weights as whole numbers, so that the result does not depend on the order of the voxels.
  void begin_dab(const DabView& dab) override {
    std::vector<std::int64_t> sum(view_.body.armature.bones.size());
    const float per_radius = static_cast<float>(1 / view_.brush.radius);
    for (const Reached::Brick& part : dab.reached.bricks) {
      const InfluenceView from = view_.weights(part.brick);
      for (int i = part.begin; i < part.end; ++i) {
        const float share = std::min(dab.reached.distance[i] * per_radius, 1.0f);
        const auto cover = static_cast<std::int64_t>(dab.strength * view_.brush.falloff(share) * kFullWeight);
        const Influence& influence = from[dab.reached.at[i]];
        for (int k = 0; k < 4; ++k) sum[influence.bone[k]] += cover * influence.weight[k];
      }
    }
    average_.clear();
    for (int b = 0; b < std::ssize(sum); ++b)
      if (sum[b] > 0) average_.emplace_back(b, double(sum[b]));
  }
  bool target_at(const VoxelView&, WeightSum& target) const override {
    target = average_;
    return !target.empty();
  }

 private:
  const BrushView view_;
  WeightSum average_;
};

}  // namespace

BrushRule average_brush() {
  return {.id = "average",
          .name = "Average",
          .description = "Moves weights towards the mean weight under the brush.",
          .looks_around = true,
          .side = [](const BrushView& view, std::span<const int>) -> std::unique_ptr<BrushSide> {
            return std::make_unique<AverageSide>(view);
          }};
}

}  // namespace limber
