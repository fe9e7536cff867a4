// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the brush that divides the weight of a bone and its parent smoothly between them at their joint: over the
// length blend_mm, the child bone's share rises from 0 to 1.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/paint/brush_rule.h"

namespace limber {

namespace {

class JointCapsuleSide final : public BrushSide {
 public:
  JointCapsuleSide(const BrushView& view, int bone) : child_(bone) {
    const Bone& child = view.body.armature.bones[bone];
    parent_ = child.parent;
    if (parent_ < 0)
      throw Error("this bone has no joint to blend across", child.name, "choose a bone that has a parent");
    const Bone& parent = view.body.armature.bones[parent_];
    // The child bone's share rises along this normal of the plane that halves the angle between the two bones.
    glm::dvec3 normal(0);
    for (const glm::dvec3 way : {child.head - parent.head, child.tail - child.head})
      if (glm::length(way) > 0) normal += glm::normalize(way);
    if (glm::length(normal) < 1e-6) normal = child.tail - child.head;
    normal = glm::normalize(normal) / std::max(view.brush.blend_mm, 1e-6);
    const AffineTransform world = world_from_voxel(view.body.volume.grid);
    for (int axis = 0; axis < 3; ++axis) along_[axis] = glm::dot(normal, world.linear[axis]);
    at_origin_ = glm::dot(normal, world.offset - child.head) + 0.5;
  }

  std::optional<WeightChange> change(const WeightRules& rules, Influence& influence, const glm::ivec3& voxel,
                                     double cover) const override {
    const std::array<int, 2> both{child_, parent_};
    const int total = WeightRules::sum_of(influence, both),
              before = WeightRules::sum_of(influence, std::span(&child_, 1));
    const double at = std::clamp(glm::dot(along_, glm::dvec3(voxel)) + at_origin_, 0.0, 1.0),
                 blend = at * at * (3 - 2 * at);
    return rules.divide(influence, child_, parent_,
                        static_cast<int>(std::lround(before + (blend * total - before) * cover)));
  }

 private:
  const int child_;
  int parent_ = -1;
  // Change of the child bone's share, before smoothing, from one voxel to the next along each axis.
  glm::dvec3 along_{0};
  double at_origin_ = 0;
};

}  // namespace

BrushRule joint_capsule_brush() {
  return {
      .id = "capsule",
      .name = "Joint capsule",
      .description = "Blends the weights of the active bone and its parent around their joint, over a length in mm.",
      .one_bone = true,
      .side = [](const BrushView& view, std::span<const int> bones) -> std::unique_ptr<BrushSide> {
        return std::make_unique<JointCapsuleSide>(view, bones[0]);
      }};
}

}  // namespace limber
