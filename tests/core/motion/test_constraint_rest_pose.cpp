// SPDX-License-Identifier: AGPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/motion/constraint_stack.h"
#include "core/pose/apply_pose_as_rest.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using test::walker;

namespace {

Pose planted_alone(const Armature& rig, const Constraint& constraint, const Pose& pose) {
  const ConstraintStack stack(std::make_shared<const Constraints>(Constraints{{constraint}}),
                              std::make_shared<const Armature>(rig));
  REQUIRE(stack.problem(0) == "");
  return stack.constrained(pose, {}, 0);
}

}  // namespace

TEST_CASE("constraints: on a new rest pose a planted hand has the same place and direction in the world") {
  const Armature rig = walker();
  test::RandomNumbers random(3);
  Pose pose = rest_pose(rig);
  for (glm::dquat& rotation : pose.rotation)
    rotation = glm::angleAxis(random.any(-0.3, 0.3), glm::normalize(glm::dvec3(random.any(-1, 1), 1, 0.3)));
  const Armature after = with_pose_as_rest(rig, pose);
  const int hand = require_bone(rig, "LeftHand");
  for (const char* target : {"", "Hips", "RightLeg"}) {
    CAPTURE(target);
    Constraint plant{.name = "Plant", .kind = ConstraintKind::Plant, .bone = "LeftHand", .target = target};
    plant.place = {220, -250, 1050};
    plant.rotation = glm::angleAxis(0.7, glm::dvec3(0, 0.6, 0.8));
    const Constraint carried = with_pose_as_rest(plant, rig, pose);
    const auto was = posed_from_rest(rig, planted_alone(rig, plant, pose))[hand];
    const auto is = posed_from_rest(after, planted_alone(after, carried, rest_pose(after)))[hand];
    for (const glm::dvec3 own :
         {rig.bones[hand].head, rig.bones[hand].tail, rig.bones[hand].tail + glm::dvec3(9, 4, 1)})
      CHECK(glm::distance(was * own, is * (posed_from_rest(rig, pose)[hand] * own)) < 0.01);
  }
}
