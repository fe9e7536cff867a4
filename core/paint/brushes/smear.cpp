// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the brush that drags weights along the stroke. Each voxel gets the weights from the position that is one
// dab movement behind it. If the path to that position leads through air, the voxel gets the weights of the last tissue
// voxel before the air.
#include <algorithm>
#include <cmath>

#include "core/paint/brush_rule.h"
#include "core/paint/weights_nearby.h"

namespace limber {

namespace {

class SmearSide final : public BrushSide {
 public:
  explicit SmearSide(const BrushView& view)
      : view_(view),
        nearby_(view_),
        voxel_from_world_(voxel_from_world(view.body.volume.grid)) {}

  void begin_dab(const DabView& dab) override { shift_ = voxel_from_world_.linear * dab.way; }

  bool target_at(const VoxelView& at, WeightSum& target) const override {
    if (shift_ == glm::dvec3(0)) return false;
    const int steps =
        static_cast<int>(std::ceil(2 * std::max({std::abs(shift_.x), std::abs(shift_.y), std::abs(shift_.z)})));
    glm::ivec3 last = at.voxel;
    for (int i = 1; i <= steps; ++i) {
      const glm::ivec3 next(glm::round(glm::dvec3(at.voxel) - shift_ * (double(i) / steps)));
      // Steps to the next voxel through one voxel face at a time: first along x, then y, then z. Air ends the path.
      for (int axis = 0; axis < 3; ++axis) {
        glm::ivec3 step = last;
        step[axis] = next[axis];
        if (step == last) continue;
        if (!nearby_.at(step)) {
          add_to(target, *nearby_.at(last), 1);
          return !target.empty();
        }
        last = step;
      }
    }
    nearby_.add_between(glm::dvec3(at.voxel) - shift_, target);
    return !target.empty();
  }

 private:
  const BrushView view_;
  const WeightsNearby nearby_;
  const AffineTransform voxel_from_world_;
  glm::dvec3 shift_{0};  // movement since the last dab, voxels; weights are dragged by this shift
};

}  // namespace

BrushRule smear_brush() {
  return {.id = "smear",
          .name = "Smear",
          .description = "Drags weights along the stroke.",
          .looks_around = true,
          .accumulates = true,
          .side = [](const BrushView& view, std::span<const int>) -> std::unique_ptr<BrushSide> {
            return std::make_unique<SmearSide>(view);
          }};
}

}  // namespace limber
