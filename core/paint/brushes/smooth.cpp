// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the brushes that move weights towards the mean around a voxel (Smooth) or away from it (Sharpen).
#include "core/paint/brush_rule.h"

namespace limber {

namespace {

// Standard deviation of the Gaussian that weights the mean, as a share of the brush's radius.
constexpr double kWidth = 0.45;

class SmoothSide : public BrushSide {
 public:
  explicit SmoothSide(const BrushView& view) : view_(view) {}

  void begin_dab(const DabView& dab) override {
    std::vector<int> bricks;
    for (const Reached::Brick& part : dab.reached.bricks) bricks.push_back(part.brick);
    view_.smooth.spread(bricks, kWidth * view_.brush.radius, view_.weights);
  }
  bool target_at(const VoxelView& at, WeightSum& target) const override {
    if (view_.smooth.is_uniform()) return false;
    view_.smooth.at(at.brick, at.cell, target);
    return !target.empty();
  }

 private:
  const BrushView view_;
};

class SharpenSide final : public SmoothSide {
 public:
  using SmoothSide::SmoothSide;

  // Computes the target 2 w - mean, where w are the voxel's own weights. So the target differs from w as much as the
  // mean does, but in the opposite direction. Negative weights are dropped. Returns false if no weight is left.
  bool target_at(const VoxelView& at, WeightSum& target) const override {
    if (!SmoothSide::target_at(at, target)) return false;
    for (auto& [_, weight] : target) weight = -weight;
    add_to(target, at.own, 2);
    std::erase_if(target, [](const auto& t) { return t.second <= 0; });
    return !target.empty();
  }
};

}  // namespace

BrushRule smooth_brush() {
  return {.id = "smooth",
          .name = "Smooth",
          .description = "Moves weights towards those of neighbouring voxels.",
          .looks_around = true,
          .side = [](const BrushView& view, std::span<const int>) -> std::unique_ptr<BrushSide> {
            return std::make_unique<SmoothSide>(view);
          }};
}

BrushRule sharpen_brush() {
  return {.id = "sharpen",
          .name = "Sharpen",
          .description = "Moves weights away from those of neighbouring voxels.",
          .looks_around = true,
          .side = [](const BrushView& view, std::span<const int>) -> std::unique_ptr<BrushSide> {
            return std::make_unique<SharpenSide>(view);
          }};
}

}  // namespace limber
