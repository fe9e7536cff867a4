// SPDX-License-Identifier: AGPL-3.0-or-later
#include <doctest/doctest.h>

#include "core/motion/constraint_stack.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using test::walker;

namespace {

using Order = std::vector<std::size_t>;

ConstraintStack made_of(const Armature& rig, std::vector<Constraint> list) {
  return {std::make_shared<const Constraints>(Constraints{std::move(list)}), std::make_shared<const Armature>(rig)};
}

Constraint made(ConstraintKind kind, const char* bone, const char* target = "") {
  Constraint constraint{.name = constraint_rule(kind).name + " " + bone, .kind = kind, .bone = bone, .target = target};
  constraint.place = {200, -300, 900};
  return constraint;
}

}  // namespace

TEST_CASE("constraint order: the later one of a bone has the last word, also where the earlier one waits for a third") {
  const Armature rig = walker();
  const Constraint aim = made(ConstraintKind::Aim, "Spine", "LeftUpLeg"),
                   limit = made(ConstraintKind::LimitRotation, "Spine"),
                   range = made(ConstraintKind::JointRange, "LeftUpLeg");
  CHECK(made_of(rig, {aim, limit}).order() == Order{0, 1});
  CHECK(made_of(rig, {aim, limit, range}).order() == Order{2, 0, 1});
  CHECK(made_of(rig, {limit, aim, range}).order() == Order{0, 2, 1});
  // The limit comes after the aim, so no component of the rotation vector exceeds 30 degrees.
  Pose pose = rest_pose(rig);
  const int spine = require_bone(rig, "Spine");
  const Pose held = made_of(rig, {aim, limit, range}).constrained(pose, {}, 0);
  const Pose free = made_of(rig, {aim, range}).constrained(pose, {}, 0);
  CHECK(2 * std::acos(std::abs(free.rotation[spine].w)) > glm::radians(60.0));
  CHECK(2 * std::acos(std::abs(held.rotation[spine].w)) < glm::radians(53.0));  // at most 30 degrees about each axis

  // The inverse kinematics (2) turns the trunk, which carries the planted hand, so it comes before the plant (0). The
  // limit (1) comes last, since it limits an arm that the plant turns.
  const Constraint plant = made(ConstraintKind::Plant, "LeftHand"),
                   elbow = made(ConstraintKind::LimitRotation, "LeftArm");
  Constraint reach = made(ConstraintKind::InverseKinematics, "LeftForeArm");
  reach.chain = 0;
  const ConstraintStack circle = made_of(rig, {plant, elbow, reach});
  CHECK(circle.order() == Order{2, 0, 1});
  for (std::size_t i = 0; i < 3; ++i) CHECK(circle.problem(i) == "");
}

TEST_CASE("constraint order: what is switched off closes no circle, and closes it when it is switched on") {
  const Armature rig = walker();
  Constraint left = made(ConstraintKind::Plant, "LeftHand", "RightHand");
  const Constraint right = made(ConstraintKind::Plant, "RightHand", "LeftHand");
  left.on = false;
  const ConstraintStack one = made_of(rig, {left, right});
  CHECK(one.problem(0) == "");
  CHECK(one.problem(1) == "");
  CHECK(one.order() == Order{1});
  left.on = true;
  const ConstraintStack both = made_of(rig, {left, right});
  CHECK(both.problem(0).find("depend on each other in a cycle") != std::string::npos);
  CHECK(both.order().empty());
  Constraint gone = made(ConstraintKind::Aim, "Tail");
  gone.on = false;
  CHECK(made_of(rig, {gone}).problem(0).find("no bone \"Tail\"") != std::string::npos);
}

TEST_CASE("constraint order: four thousand constraints of the same bones are ordered within seconds") {
  const Armature rig = walker();
  std::vector<Constraint> list;
  for (std::size_t i = 0; i < kMostConstraints; ++i)
    list.push_back(made(ConstraintKind::Plant, i % 2 == 0 ? "LeftHand" : "RightHand", "Spine"));
  const ConstraintStack stack = made_of(rig, list);
  REQUIRE(stack.order().size() == kMostConstraints);
  for (std::size_t i = 0; i < kMostConstraints; ++i) REQUIRE(stack.order()[i] == i);
}
