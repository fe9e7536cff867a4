// SPDX-License-Identifier: AGPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/motion/constraint_stack.h"
#include "core/rig/joint_limits.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using test::walker;

namespace {

Pose constrained_alone(const Armature& rig, const Constraint& constraint, const Pose& pose) {
  const ConstraintStack stack(std::make_shared<const Constraints>(Constraints{{constraint}}),
                              std::make_shared<const Armature>(rig));
  REQUIRE(stack.problem(0) == "");
  return stack.constrained(pose, {}, 0);
}

}  // namespace

TEST_CASE("constraints: parts of a rotation are copied alike, wherever the body is turned") {
  const Armature rig = walker();
  const int hips = require_bone(rig, "Hips"), chest = require_bone(rig, "Spine"), leg = require_bone(rig, "LeftUpLeg");
  const glm::dmat3 axes = rest_axes(rig.bones[leg]);
  for (const double heading : {0.0, 90.0, 179.0, 180.0, 181.0, 270.0})
    for (const int copied : {0, 1}) {
      CAPTURE(heading);
      Constraint copy{.name = "Copy", .kind = ConstraintKind::CopyRotation, .bone = "LeftUpLeg", .target = "Spine"};
      copy.axes = {copied == 0, copied == 1, false};
      Pose pose = rest_pose(rig);
      pose.rotation[hips] = glm::angleAxis(glm::radians(heading), glm::dvec3(0, 0, 1));
      pose.rotation[chest] = glm::angleAxis(glm::radians(10.0), axes[0]);
      const glm::dquat leg_turn = constrained_alone(rig, copy, pose).rotation[leg];
      const glm::dquat wanted = copied == 0 ? pose.rotation[chest] : glm::dquat(1, 0, 0, 0);
      CHECK(std::abs(glm::dot(leg_turn, wanted)) > 1 - 1e-12);
    }
}
