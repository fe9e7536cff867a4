// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/fitted_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/rig/anatomical_position.h"

namespace limber {

namespace {

// A hinge counts as bending one way only if it bends backwards beyond straight by at most this angle, radians. Such a
// limb also never rests bent backwards by more than this angle.
constexpr double kBentBack = 15 * std::numbers::pi / 180;
// A hinge's axis counts as wrong if its angle to the axis about which the resting limb is bent is larger than this,
// radians. The axis of a forearm that points sideways deviates by less.
constexpr double kFarOff = 35 * std::numbers::pi / 180;

// Returns the hinge axis of an elbow or knee. This is `carried`, the old axis rotated with the bone, unless the limb
// rests clearly bent and `carried` is far from the normal of the plane of its two bones. In that case returns this
// normal, because only the bend shows how a limb is rotated about its own length.
glm::dvec3 axis_of_bend(const Armature& rig, int index, const glm::dvec3& carried) {
  const Bone& bone = rig.bones[index];
  const Bone& parent = rig.bones[bone.parent];
  const glm::dvec3 above = parent.tail - parent.head, below = bone.tail - bone.head, across = glm::cross(above, below);
  const double sine = glm::length(across);
  if (std::atan2(sine, glm::dot(above, below)) < kBentBack) return carried;
  return glm::dot(across / sine, carried) < std::cos(kFarOff) ? across / sine : carried;
}

void fit_hinge(Armature& fitted, const Armature& rig, int index, const std::optional<JointRole>& role) {
  const JointLimits& before = rig.bones[index].limits;
  JointLimits& limits = fitted.bones[index].limits;
  const std::optional<double> zero = told_hinge_angle(rig, index, before.axis);
  if (!zero) return;
  const double low = before.minimum + *zero, high = before.maximum + *zero;
  const bool bends_one_way = low >= -kBentBack && high > kBentBack;
  if (bends_one_way && role && (role->part == BodyPart::Forearm || role->part == BodyPart::Shank))
    limits.axis = axis_of_bend(fitted, index, limits.axis);
  const std::optional<double> now = told_hinge_angle(fitted, index, limits.axis);
  if (!now || *now == *zero) return;
  double at_rest = *now;
  if (bends_one_way && at_rest < std::min(low, 0.0) - kBentBack) {
    limits.axis = -limits.axis;
    at_rest = -at_rest;
  }
  limits.minimum = std::min(0.0, low - at_rest);
  limits.maximum = std::max(0.0, high - at_rest);
}

void fit_ball(Armature& fitted, const Armature& rig, int index, BodyPart part) {
  const double cone = rig.bones[index].limits.cone;
  const double before = glm::length(ball_swing_at_rest(rig, index, part));
  const double now = glm::length(ball_swing_at_rest(fitted, index, part));
  if (before == now || cone >= std::numbers::pi) return;
  const double nearest = std::max(0.0, before - cone), widest = std::min(before + cone, std::numbers::pi);
  fitted.bones[index].limits.cone = std::max({widest - now, now - nearest, 0.0});
}

}  // namespace

Armature with_fitted_limits(Armature fitted, const Armature& rig) {
  const auto roles = roles_of(rig);
  for (int b = 0; b < std::ssize(fitted.bones); ++b) {
    const JointLimits::Type type = rig.bones[b].limits.type;
    if (type == JointLimits::Type::Hinge) fit_hinge(fitted, rig, b, roles[b]);
    if (type == JointLimits::Type::Ball && roles[b]) fit_ball(fitted, rig, b, roles[b]->part);
  }
  return fitted;
}

}  // namespace limber
