// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/capsule_shares.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {

// Half width, mm, of the slab around the joint in which the limb's thickness is measured. Only tissue whose weights the
// joint field may change counts.
constexpr double kSlab = 20;
constexpr double kLeastThickness = 5;  // a thinner limb counts as this thick, mm

double smooth_rise(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

CapsuleShape::CapsuleShape(const WeightedBody& body, const JointField& field, const JointMotion& motion)
    : field_(field) {
  const Bone &child = body.armature.bones[motion.bone], &parent = body.armature.bones[child.parent];
  for (const glm::dvec3 way : {child.head - parent.head, child.tail - child.head})
    if (glm::length(way) > 0) normal_ += glm::normalize(way);
  if (glm::length(normal_) < 1e-6) normal_ = child.tail - child.head;
  normal_ = glm::normalize(normal_);
  const JointTurn& turn =
      *std::max_element(motion.turns.begin(), motion.turns.end(),
                        [](const JointTurn& a, const JointTurn& b) { return std::abs(a.angle) < std::abs(b.angle); });
  flexor_ = glm::cross(turn.axis, normal_) * (turn.angle < 0 ? -1.0 : 1.0);
  flexor_ = glm::length(flexor_) > 0.1 ? glm::normalize(flexor_) : glm::dvec3(0);

  const AffineTransform world = world_from_voxel(body.volume.grid);
  double low = 0, high = 0;
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    if (field.mask(index) < 0.5) return;
    const glm::dvec3 p = world * glm::dvec3(voxel) - motion.centre;
    if (std::abs(glm::dot(p, normal_)) > kSlab) return;
    low = std::min(low, glm::dot(p, flexor_));
    high = std::max(high, glm::dot(p, flexor_));
  });
  thickness_ = std::max(high - low, kLeastThickness);
}

std::vector<double> CapsuleShape::shares(const CapsuleWidths& widths) const {
  std::vector<double> shares(field_.node_count());
  for (std::int64_t n = 0; n < field_.node_count(); ++n) {
    const glm::dvec3& p = field_.node_position(n);
    const double side = smooth_rise(0.5 + glm::dot(p, flexor_) / thickness_),
                 width = widths.extensor + (widths.flexor - widths.extensor) * side;
    shares[n] = smooth_rise(0.5 + glm::dot(p, normal_) / width);
  }
  return shares;
}

}  // namespace limber
