// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the brush that copies weights from the surroundings of a position that the user has set. During a stroke,
// all weights are copied over one fixed offset: the offset from the user's position to the centre of the first dab.
#include "core/paint/brush_rule.h"
#include "core/paint/weights_nearby.h"

namespace limber {

namespace {

class CloneSide final : public BrushSide {
 public:
  explicit CloneSide(const BrushView& view)
      : view_(view),
        nearby_(view_),
        voxel_from_world_(voxel_from_world(view.body.volume.grid)) {}

  void begin_dab(const DabView& dab) override {
    if (shift_) return;
    const glm::dvec3 from = view_.mirror ? view_.mirror->place(view_.brush.reference) : view_.brush.reference;
    shift_ = voxel_from_world_.linear * (dab.centre - from);
  }

  // Computes the weights to copy. Returns false when there is air at the position to copy from.
  bool target_at(const VoxelView& at, WeightSum& target) const override {
    nearby_.add_between(glm::dvec3(at.voxel) - *shift_, target);
    return !target.empty();
  }

 private:
  const BrushView view_;
  const WeightsNearby nearby_;
  const AffineTransform voxel_from_world_;
  std::optional<glm::dvec3> shift_;  // offset from the copied position to the painted voxel, voxels
};

}  // namespace

BrushRule clone_brush() {
  return {
      .id = "clone",
      .name = "Clone",
      .description =
          "Copies weights from the cross-hair to the brush. During a stroke, the source moves along with the brush.",
      .looks_around = true,
      .side = [](const BrushView& view, std::span<const int>) -> std::unique_ptr<BrushSide> {
        return std::make_unique<CloneSide>(view);
      }};
}

}  // namespace limber
