// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/fitted_limits.h"

#include <algorithm>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

#include "core/autorig/auto_rig.h"
#include "core/phantom/phantom.h"
#include "core/rig/anatomical_position.h"
#include "core/rig/joint_limits.h"
#include "core/rig/joint_ranges.h"
#include "core/rig_io/rig_templates.h"

using namespace limber;

namespace {

// Returns the rig with another rest pose: one bone and its descendants are turned about `axis`. Their limits keep their
// angles, and the axes of the limits turn with the bones.
Armature resting_turned(Armature rig, const std::string& name, const glm::dvec3& axis, double degrees) {
  const int top = *rig.find(name);
  const glm::dquat turn = glm::angleAxis(glm::radians(degrees), axis);
  const glm::dvec3 pivot = rig.bones[top].head;
  std::vector<bool> turns(rig.bones.size());
  for (int b = top; b < std::ssize(rig.bones); ++b) {
    Bone& bone = rig.bones[b];
    turns[b] = b == top || (bone.parent >= 0 && turns[bone.parent]);
    if (!turns[b]) continue;
    bone.head = pivot + turn * (bone.head - pivot);
    bone.tail = pivot + turn * (bone.tail - pivot);
    bone.limits.axis = turn * bone.limits.axis;
  }
  return rig;
}

const Bone& bone_of(const Armature& rig, const std::string& name) { return rig.bones[*rig.find(name)]; }

// Returns the angle in degrees between a bone and its parent after the bone is turned by `angle` (radians) about its
// hinge.
double bent_to(const Armature& rig, const std::string& name, double angle) {
  const Bone& bone = bone_of(rig, name);
  const Bone& above = rig.bones[bone.parent];
  const glm::dvec3 along = glm::angleAxis(angle, bone.limits.axis) * (bone.tail - bone.head);
  return glm::degrees(std::acos(glm::dot(glm::normalize(along), glm::normalize(above.tail - above.head))));
}

}  // namespace

TEST_CASE("fitted limits: an elbow reaches from straight to the template's end, however the body rests") {
  const Armature rig = rig_template("arm");
  const glm::dvec3 axis = bone_of(rig, "Forearm").limits.axis;
  const std::string range = limits_text(rig, *rig.find("Forearm"));
  CHECK(range == "hinge, 0 to 145 degrees");
  for (const double more : {-25.0, 0.0, 36.0, 100.0}) {
    CAPTURE(more);
    const Armature fitted = with_fitted_limits(resting_turned(rig, "Forearm", axis, more), rig);
    const JointLimits& limits = bone_of(fitted, "Forearm").limits;
    CHECK(limits_text(fitted, *rig.find("Forearm")) == range);
    CHECK(bent_to(fitted, "Forearm", limits.maximum) == doctest::Approx(145).epsilon(1e-3));
    CHECK(bent_to(fitted, "Forearm", limits.minimum) < 0.1);
    CHECK(limit_excess(bone_of(fitted, "Forearm"), {1, 0, 0, 0}) == 0);
    // The limits of the other joints do not change.
    CHECK(bone_of(fitted, "IndexMiddle").limits.maximum == doctest::Approx(bone_of(rig, "IndexMiddle").limits.maximum));
    CHECK(bone_of(fitted, "UpperArm").limits == bone_of(rig, "UpperArm").limits);
  }
}

TEST_CASE("fitted limits: rest stays allowed beyond the range, and a hinge the wrong way round is turned about") {
  const Armature rig = rig_template("arm");
  const glm::dvec3 axis = bone_of(rig, "Forearm").limits.axis;
  const Armature beyond = with_fitted_limits(resting_turned(rig, "Forearm", axis, 130), rig);
  CHECK(bone_of(beyond, "Forearm").limits.maximum == 0);
  CHECK(bent_to(beyond, "Forearm", bone_of(beyond, "Forearm").limits.minimum) < 0.1);
  const Armature back = with_fitted_limits(resting_turned(rig, "Forearm", axis, -85), rig);
  CHECK(glm::dot(bone_of(back, "Forearm").limits.axis, axis) < -0.99);
  CHECK(bent_to(back, "Forearm", bone_of(back, "Forearm").limits.maximum) == doctest::Approx(145).epsilon(1e-3));
  CHECK(bent_to(back, "Forearm", bone_of(back, "Forearm").limits.minimum) < 0.1);
}

TEST_CASE("fitted limits: an elbow bent across the axis that was carried along bends on as it rests") {
  const Armature rig = rig_template("arm");
  Armature fitted = rig;
  // The elbow is bent by 25 degrees, and its hinge axis is turned about the upper arm, as if it had been fitted to the
  // wrong side of the limb.
  Bone& forearm = fitted.bones[*fitted.find("Forearm")];
  const glm::dvec3 right = forearm.limits.axis, along = glm::normalize(forearm.tail - forearm.head);
  for (const auto& [degrees, kept] : {std::pair(20.0, true), {80.0, false}, {180.0, false}}) {
    CAPTURE(degrees);
    forearm.limits.axis = glm::angleAxis(glm::radians(degrees), along) * right;
    const JointLimits limits = bone_of(with_fitted_limits(fitted, rig), "Forearm").limits;
    CHECK((glm::distance(limits.axis, right) > 0.1) == kept);
    if (kept) continue;
    CHECK(glm::degrees(limits.minimum) == doctest::Approx(-25).epsilon(1e-3));
    CHECK(glm::degrees(limits.maximum) == doctest::Approx(120).epsilon(1e-3));
  }
}

TEST_CASE("fitted limits: a shoulder's cone reaches as far from the hanging arm as the template's") {
  const Armature rig = rig_template("adult");
  const int arm = *rig.find("LeftUpperArm");
  const auto swing = [&](const Armature& of) {
    return glm::degrees(glm::length(ball_swing_at_rest(of, arm, BodyPart::UpperArm)));
  };
  const double before = swing(rig), cone = glm::degrees(rig.bones[arm].limits.cone);
  CHECK(with_fitted_limits(rig, rig) == rig);
  const Armature lifted = resting_turned(rig, "LeftUpperArm", {0, -1, 0}, 40);
  const double now = swing(lifted);
  CHECK(now > before + 35);
  const double fitted = glm::degrees(with_fitted_limits(lifted, rig).bones[arm].limits.cone);
  CHECK(fitted == doctest::Approx(std::max(before + cone - now, now)));
  CHECK(fitted < cone - 30);
}

TEST_CASE("fitted limits: auto-fit of a bent arm leaves every hinge the template's anatomical range" *
          doctest::test_suite("slow")) {
  const Phantom phantom = make_arm_phantom(5);
  // The template's elbow is made straight; the body's elbow is bent by 25 degrees.
  const Armature bent = rig_template("arm");
  const glm::dvec3 axis = bone_of(bent, "Forearm").limits.axis;
  const Armature rig = with_fitted_limits(resting_turned(bent, "Forearm", axis, -25), bent);
  const AutoFit fitted = auto_fit(phantom.volume, phantom.tissues, rig);
  int moved = 0;
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    const JointLimits& limits = fitted.armature.bones[b].limits;
    if (limits.type != JointLimits::Type::Hinge) continue;
    INFO(rig.bones[b].name);
    const double at_rest = hinge_angle_at_rest(rig, b, rig.bones[b].limits.axis);
    const double now = hinge_angle_at_rest(fitted.armature, b, limits.axis);
    moved += std::abs(at_rest - now) > glm::radians(3.0);
    CHECK(limit_excess(fitted.armature.bones[b], {1, 0, 0, 0}) == 0);
    const double low = rig.bones[b].limits.minimum + at_rest, high = rig.bones[b].limits.maximum + at_rest;
    CHECK(limits.minimum + now == doctest::Approx(std::min(low, now)).epsilon(1e-6));
    CHECK(limits.maximum + now == doctest::Approx(std::max(high, now)).epsilon(1e-6));
  }
  CHECK(moved > 0);
  const Bone& forearm = bone_of(fitted.armature, "Forearm");
  CHECK(glm::degrees(forearm.limits.minimum) == doctest::Approx(-25).epsilon(0.2));
  CHECK(glm::degrees(forearm.limits.maximum) == doctest::Approx(120).epsilon(0.05));
}
