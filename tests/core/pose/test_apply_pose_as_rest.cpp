// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/apply_pose_as_rest.h"

#include <random>

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE("apply pose: what is at rest then stands where the pose had it, and hinges count from there") {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto any = [&] { return glm::dvec3(normal(random), normal(random), normal(random)); };
  Armature rig;
  for (int b = 0; b < 5; ++b) {
    Bone bone{"Bone " + std::to_string(b), b - 1, any() * 50.0, any() * 50.0, normal(random), {}};
    bone.limits = {.type = JointLimits::Type::Hinge, .axis = glm::normalize(any()), .minimum = -0.5, .maximum = 2};
    rig.bones.push_back(bone);
  }
  Pose pose = rest_pose(rig);
  std::vector<double> angles;
  for (int b = 0; b < 5; ++b) {
    angles.push_back(-0.4 + 0.5 * b);
    pose.rotation[b] = glm::angleAxis(angles.back(), rig.bones[b].limits.axis);
  }
  pose.root_translation = {3, -4, 5};
  const Armature at_rest = with_pose_as_rest(rig, pose);
  const auto posed = posed_from_rest(rig, pose);
  // Bending a joint further from the new rest pose gives the same as bending it by the sum from the old one.
  Pose further = pose, from_there = rest_pose(at_rest);
  for (int b = 0; b < 5; ++b) {
    const glm::dmat3 axes = glm::mat3_cast(posed[b].rotation) * rest_axes(rig.bones[b]);
    for (int axis = 0; axis < 3; ++axis) CHECK(glm::distance(rest_axes(at_rest.bones[b])[axis], axes[axis]) < 1e-9);
    const JointLimits& limits = at_rest.bones[b].limits;
    CHECK(limits.minimum == doctest::Approx(std::min(0.0, -0.5 - angles[b])));
    CHECK(limits.maximum == doctest::Approx(2 - angles[b]));
    further.rotation[b] = glm::angleAxis(angles[b] + 0.3, rig.bones[b].limits.axis);
    from_there.rotation[b] = glm::angleAxis(0.3, limits.axis);
  }
  const auto both = posed_from_rest(rig, further), again = posed_from_rest(at_rest, from_there);
  for (int b = 0; b < 5; ++b) {
    CHECK(glm::distance(both[b] * rig.bones[b].tail, again[b] * at_rest.bones[b].tail) < 1e-9);
    CHECK(glm::distance(both[b] * rig.bones[b].head, again[b] * at_rest.bones[b].head) < 1e-9);
  }
}
