// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks constraints by this file's own forward kinematics with matrices, independently of the program's quaternions
// and solvers.
#include <cmath>
#include <numbers>
#include <set>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/apply_constraints.h"
#include "core/motion/clip_speed.h"
#include "core/motion/constraint_stack.h"
#include "core/motion/mirror_clip.h"
#include "core/rig/joint_limits.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using test::walker;

namespace {

// Returns the matrix that takes a bone from rest to the pose, multiplied along its chain of joints.
glm::dmat4 posed_matrix(const Armature& rig, const Pose& pose, int bone) {
  glm::dmat4 result(1);
  for (int b = bone; b >= 0; b = rig.bones[b].parent) {
    glm::dmat4 about(glm::mat3_cast(pose.rotation[b]));
    const glm::dvec3 head = rig.bones[b].head;
    about[3] = glm::dvec4(head - glm::dvec3(about * glm::dvec4(head, 0)), 1);
    result = about * result;
    if (rig.bones[b].parent < 0) result[3] += glm::dvec4(pose.root_translation, 0);
  }
  return result;
}
glm::dvec3 at(const Armature& rig, const Pose& pose, int bone, const glm::dvec3& rest) {
  return glm::dvec3(posed_matrix(rig, pose, bone) * glm::dvec4(rest, 1));
}
glm::dvec3 head_of(const Armature& rig, const Pose& pose, int bone) {
  return at(rig, pose, bone, rig.bones[bone].head);
}
glm::dvec3 tail_of(const Armature& rig, const Pose& pose, int bone) {
  return at(rig, pose, bone, rig.bones[bone].tail);
}
double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}
double largest_difference(const glm::dmat4& a, const glm::dmat4& b) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(a[i][j] - b[i][j]));
  return most;
}

int bone_of(const Armature& rig, const char* name) { return require_bone(rig, name); }

Pose random_pose(const Armature& rig, test::RandomNumbers& random, double most = 0.9) {
  Pose pose = rest_pose(rig);
  for (glm::dquat& rotation : pose.rotation)
    rotation = exponential(most * glm::dvec3(random.any(-1, 1), random.any(-1, 1), random.any(-1, 1)));
  pose.root_translation = {random.any(-50, 50), random.any(-50, 50), random.any(-50, 50)};
  return pose;
}

ConstraintStack stack_of(const Armature& rig, std::vector<Constraint> list) {
  return {std::make_shared<const Constraints>(Constraints{std::move(list)}), std::make_shared<const Armature>(rig)};
}
Pose constrained(const Armature& rig, const Constraint& constraint, const Pose& pose) {
  const ConstraintStack stack = stack_of(rig, {constraint});
  REQUIRE(stack.problem(0) == "");
  return stack.constrained(pose, {}, 0);
}

Constraint plant_of(const char* hand, const char* target, const glm::dvec3& place) {
  Constraint plant{.name = "Plant", .kind = ConstraintKind::Plant, .bone = hand, .target = target, .place = place};
  plant.keeps_rotation = false;
  return plant;
}

// Returns one constraint of each kind that can be applied to the walker.
std::vector<Constraint> one_of_each() {
  return {{.name = "Copy", .kind = ConstraintKind::CopyRotation, .bone = "LeftHand", .target = "RightFoot"},
          {.name = "Limit",
           .kind = ConstraintKind::LimitRotation,
           .bone = "LeftArm",
           .minimum = glm::dvec3(-0.1),
           .maximum = glm::dvec3(0.1)},
          {.name = "Range", .kind = ConstraintKind::JointRange, .bone = "RightForeArm"},
          {.name = "Aim", .kind = ConstraintKind::Aim, .bone = "RightArm", .place{500, -700, 1500}},
          {.name = "Plant", .kind = ConstraintKind::Plant, .bone = "LeftHand", .place{350, -250, 1300}},
          {.name = "IK", .kind = ConstraintKind::InverseKinematics, .bone = "RightHand", .place{-300, -300, 1200}}};
}

Armature limited_walker() {
  Armature rig = walker();
  rig.bones[bone_of(rig, "RightForeArm")].limits = {
      .type = JointLimits::Type::Hinge, .axis{1, 0, 0}, .minimum = -0.2, .maximum = 0.3};
  return rig;
}

}  // namespace

TEST_CASE("constraints: an aimed axis points at its target within 0.01 degrees, and the bone does not roll") {
  const Armature rig = walker();
  test::RandomNumbers random(11);
  for (int trial = 0; trial < 60; ++trial) {
    const Pose pose = random_pose(rig, random);
    const int bone = bone_of(rig, "Spine"), foot = bone_of(rig, "LeftFoot");
    const bool on_bone = trial % 2 == 0;
    Constraint aim{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "Spine", .target = on_bone ? "LeftFoot" : ""};
    aim.place = on_bone ? rig.bones[foot].tail : glm::dvec3(random.any(-900, 900), -800, random.any(0, 2000));
    aim.aim = static_cast<BoneAxis>(trial % 6);
    const Pose aimed = constrained(rig, aim, pose);
    const glm::dvec3 place = on_bone ? tail_of(rig, aimed, foot) : aim.place, head = head_of(rig, aimed, bone);
    const glm::dvec3 rest = (trial % 2 == 0 ? 1.0 : -1.0) * rest_axes(rig.bones[bone])[trial % 6 / 2];
    const glm::dmat3 turned(posed_matrix(rig, aimed, bone)), before(posed_matrix(rig, pose, bone));
    CHECK(degrees_between(turned * rest, place - head) < 0.01);
    // The constraint turns the bone by the shortest rotation: its angle is that between the two directions.
    const glm::dmat3 turn = turned * glm::transpose(before);
    const double angle = std::acos(std::clamp((turn[0][0] + turn[1][1] + turn[2][2] - 1) / 2, -1.0, 1.0));
    CHECK(glm::degrees(angle) == doctest::Approx(degrees_between(before * rest, place - head)).epsilon(1e-6));
  }
}

TEST_CASE("constraints: a planted hand is within 0.5 mm of a place in reach, else as near as any pose of the arm is") {
  const Armature rig = walker();
  const int upper = bone_of(rig, "LeftArm"), lower = bone_of(rig, "LeftForeArm"), hand = bone_of(rig, "LeftHand"),
            spine = bone_of(rig, "Spine");
  const double a = glm::distance(rig.bones[upper].head, rig.bones[lower].head),
               b = glm::distance(rig.bones[lower].head, rig.bones[hand].head);
  test::RandomNumbers random(5);
  double worst = 0;
  int missed = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Pose pose = random_pose(rig, random, 0.6);
    const glm::dvec3 shoulder = head_of(rig, pose, upper);
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(random.any(-1, 1), random.any(-1, 1), random.any(-1, 1)) + glm::dvec3(1e-3));
    const double away = trial % 4 == 0 ? random.any(0, 60) : random.any(40, 800);
    const glm::dvec3 joint = shoulder + away * direction;
    // In every second trial, the wrist's target is fixed to the chest, from which the arm hangs.
    const bool on_bone = trial % 2 == 0;
    const glm::dvec3 place =
        on_bone ? glm::dvec3(glm::inverse(posed_matrix(rig, pose, spine)) * glm::dvec4(joint, 1)) : joint;
    Constraint plant = plant_of("LeftHand", on_bone ? "Spine" : "", place);
    plant.point = PlantPoint::Joint;
    const Pose planted = constrained(rig, plant, pose);
    const glm::dvec3 wrist = head_of(rig, planted, hand);
    const double nearest = std::max({0.0, away - (a + b), std::abs(a - b) - away});
    missed += nearest > 0;
    worst = std::max(worst, std::abs(glm::distance(wrist, joint) - nearest));
    // The hand keeps its direction, and no other bone turns.
    CHECK(largest_difference(posed_matrix(rig, planted, hand), posed_matrix(rig, pose, hand)) < 1e-9);
    for (int bone = 0; bone < std::ssize(rig.bones); ++bone)
      if (bone != upper && bone != lower && bone != hand) CHECK(planted.rotation[bone] == pose.rotation[bone]);
  }
  MESSAGE("at most ", worst, " mm off the nearest place, ", missed, " of 400 out of reach");
  CHECK(missed > 100);
  CHECK(missed < 300);
  CHECK(worst < 1e-3);
}

TEST_CASE("constraints: a hand planted on the hips keeps place and direction on them, by its tip") {
  const Armature rig = walker();
  const int hand = bone_of(rig, "RightHand"), hips = bone_of(rig, "Hips");
  test::RandomNumbers random(6);
  Constraint plant = plant_of("RightHand", "Hips", {-150, -60, 960});
  plant.keeps_rotation = true;
  plant.rotation = exponential({0.2, 0.4, -1.2});
  for (int trial = 0; trial < 50; ++trial) {
    const Pose planted = constrained(rig, plant, random_pose(rig, random, 0.25));
    CHECK(glm::distance(tail_of(rig, planted, hand), at(rig, planted, hips, plant.place)) < 0.5);
    const glm::dmat4 wanted = posed_matrix(rig, planted, hips) * glm::dmat4(glm::mat3_cast(plant.rotation));
    CHECK(largest_difference(posed_matrix(rig, planted, hand), wanted) < 1e-9);
  }
}

TEST_CASE("constraints: knees and elbows bend their own way when a straight limb is planted") {
  Armature rig = walker();
  for (const char* side : {"Left", "Right"}) {  // make the knees exactly straight at rest
    const int shank = bone_of(rig, (std::string(side) + "Leg").c_str()), lower = shank;
    rig.bones[shank].head.y = rig.bones[shank - 1].tail.y = 0;
    CHECK(rig.bones[lower].tail.y == 0);
  }
  const Pose rest = rest_pose(rig);
  const Pose squat = constrained(rig, plant_of("LeftFoot", "", {100, -150, 200}), rest);
  const glm::dvec3 hip = head_of(rig, squat, bone_of(rig, "LeftUpLeg")),
                   knee = head_of(rig, squat, bone_of(rig, "LeftLeg"));
  CHECK(glm::distance(tail_of(rig, squat, bone_of(rig, "LeftFoot")), glm::dvec3(100, -150, 200)) < 1e-6);
  CHECK(knee.y < hip.y - 50);  // forwards: the body looks along -y
}

TEST_CASE("constraints: inverse kinematics brings a tail within 0.5 mm of its target, and keeps limits") {
  Armature rig = walker();
  test::RandomNumbers random(8);
  const int upper = bone_of(rig, "LeftArm"), hand = bone_of(rig, "LeftHand");
  double length = 0;
  for (const char* name : {"LeftArm", "LeftForeArm", "LeftHand"})
    length += glm::distance(rig.bones[bone_of(rig, name)].head, rig.bones[bone_of(rig, name)].tail);
  for (int trial = 0; trial < 60; ++trial) {
    const Pose pose = random_pose(rig, random, 0.5);
    const glm::dvec3 shoulder = head_of(rig, pose, upper);
    const double away = random.any(150, 1.3 * length);
    const glm::dvec3 place = shoulder + away * glm::normalize(glm::dvec3(random.any(-1, 1), -1, random.any(-1, 1)));
    const Constraint ik{
        .name = "IK", .kind = ConstraintKind::InverseKinematics, .bone = "LeftHand", .place = place, .chain = 3};
    const Pose reached = constrained(rig, ik, pose);
    CHECK(glm::distance(tail_of(rig, reached, hand), place) < std::max(0.0, away - length) + 0.5);
  }
  const int elbow = bone_of(rig, "LeftForeArm");
  rig.bones[elbow].limits = {.type = JointLimits::Type::Hinge, .axis{-1, 0, 0}, .minimum = 0, .maximum = 1};
  const Constraint folded{.name = "IK",
                          .kind = ConstraintKind::InverseKinematics,
                          .bone = "LeftHand",
                          .place = rig.bones[upper].head + glm::dvec3(0, -150, 0),
                          .chain = 3};
  const Pose held = constrained(rig, folded, rest_pose(rig));
  // The hand misses the target by more than 1 mm, since the elbow would have to bend beyond its limit.
  CHECK(glm::distance(tail_of(rig, held, hand), folded.place) > 1);
  const double bend =
      degrees_between(rig.bones[elbow].tail - rig.bones[elbow].head,
                      glm::mat3_cast(held.rotation[elbow]) * (rig.bones[elbow].tail - rig.bones[elbow].head));
  CHECK(bend < glm::degrees(1.0) + 1e-6);
}

TEST_CASE("constraints: a copied rotation is exact, in the world and relative to the parent") {
  const Armature rig = walker();
  test::RandomNumbers random(4);
  const int from = bone_of(rig, "LeftUpLeg"), to = bone_of(rig, "RightForeArm");
  for (int trial = 0; trial < 30; ++trial) {
    const Pose pose = random_pose(rig, random);
    Constraint copy{
        .name = "Copy", .kind = ConstraintKind::CopyRotation, .bone = "RightForeArm", .target = "LeftUpLeg"};
    const Pose in_world = constrained(rig, copy, pose);
    CHECK(largest_difference(posed_matrix(rig, in_world, to), posed_matrix(rig, in_world, from)) < 1e-12);
    copy.space = RotationSpace::Parent;
    const Pose relative = constrained(rig, copy, pose);
    CHECK(relative.rotation[to] == pose.rotation[from]);
    // With one axis only, a rotation about that axis is copied whole, and one about another axis not at all.
    copy.axes = {false, true, false};
    const glm::dvec3 along = rest_axes(rig.bones[to])[1], across = rest_axes(rig.bones[to])[0];
    const double angle = random.any(-2, 2);
    Pose twisted = rest_pose(rig), bent = rest_pose(rig);
    twisted.rotation[from] = glm::angleAxis(angle, along);
    bent.rotation[from] = glm::angleAxis(angle, across);
    CHECK(std::abs(glm::dot(constrained(rig, copy, twisted).rotation[to], twisted.rotation[from])) > 1 - 1e-12);
    CHECK(std::abs(constrained(rig, copy, bent).rotation[to].w) > 1 - 1e-12);
  }
}

TEST_CASE("constraints: limited rotations are held about each axis, and what is within stays bit for bit") {
  const Armature rig = limited_walker();
  test::RandomNumbers random(9);
  const int bone = bone_of(rig, "LeftArm"), elbow = bone_of(rig, "RightForeArm");
  Constraint limit{.name = "Limit", .kind = ConstraintKind::LimitRotation, .bone = "LeftArm"};
  limit.axes = {true, false, true};
  limit.minimum = {-0.3, 0, 0.1};
  limit.maximum = {0.2, 0, 0.5};
  for (int trial = 0; trial < 60; ++trial) {
    const Pose pose = random_pose(rig, random, 1.5);
    const Pose held = constrained(rig, limit, pose);
    // Computes the rotation vector from the matrix: the axis from its skew part, the angle from its trace.
    const auto parts = [&](const Pose& p) {
      const glm::dmat3 own = rest_axes(rig.bones[bone]), m(glm::mat3_cast(p.rotation[bone]));
      const double angle = std::acos(std::clamp((m[0][0] + m[1][1] + m[2][2] - 1) / 2, -1.0, 1.0));
      const glm::dvec3 skew(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
      return glm::transpose(own) * (angle / (2 * std::sin(angle)) * skew);
    };
    const glm::dvec3 before = parts(pose), after = parts(held);
    CHECK(after.x == doctest::Approx(std::clamp(before.x, -0.3, 0.2)).epsilon(1e-6));
    CHECK(after.y == doctest::Approx(before.y).epsilon(1e-6));
    CHECK(after.z == doctest::Approx(std::clamp(before.z, 0.1, 0.5)).epsilon(1e-6));
    CHECK(std::abs(glm::dot(constrained(rig, limit, held).rotation[bone], held.rotation[bone])) > 1 - 1e-12);
    const Pose bent =
        constrained(rig, {.name = "Range", .kind = ConstraintKind::JointRange, .bone = "RightForeArm"}, pose);
    const glm::dvec3 axis = glm::mat3_cast(bent.rotation[elbow]) * glm::dvec3(1, 0, 0);
    CHECK(degrees_between(axis, {1, 0, 0}) < 1e-5);
    const double angle = degrees_between(glm::mat3_cast(bent.rotation[elbow]) * glm::dvec3(0, 0, 1), {0, 0, 1});
    CHECK(angle < glm::degrees(0.3) + 1e-6);
  }
  Pose small = rest_pose(rig);
  small.rotation[bone] = exponential(rest_axes(rig.bones[bone]) * glm::dvec3(0.1, 0.7, 0.3));
  CHECK(constrained(rig, limit, small) == small);
}

TEST_CASE("constraints: weight 0 leaves every bit of the pose, weight 1 is the solution, between them is the slerp") {
  const Armature rig = limited_walker();
  test::RandomNumbers random(21);
  const Pose pose = random_pose(rig, random, 0.5);
  for (Constraint constraint : one_of_each()) {
    CAPTURE(constraint.name);
    const auto with = [&](double weight) {
      constraint.weight = weight;
      return constrained(rig, constraint, pose);
    };
    const Pose none = with(0), full = with(1);
    CHECK(none == pose);
    CHECK(full != pose);
    const Pose third = with(1.0 / 3);
    for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone) {
      const auto angle = [](const glm::dquat& from, const glm::dquat& to) {
        const glm::dmat3 m = glm::mat3_cast(to) * glm::transpose(glm::mat3_cast(from));
        const glm::dvec3 skew(m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]);
        return std::atan2(glm::length(skew), m[0][0] + m[1][1] + m[2][2] - 1);
      };
      const double whole = angle(pose.rotation[bone], full.rotation[bone]);
      CHECK(angle(pose.rotation[bone], third.rotation[bone]) == doctest::Approx(whole / 3).epsilon(1e-6));
      CHECK(angle(third.rotation[bone], full.rotation[bone]) == doctest::Approx(whole * 2 / 3).epsilon(1e-6));
    }
    constraint.on = false;
    CHECK(with(1) == pose);
  }
}

TEST_CASE("constraints: a keyed weight switches between keys and inverse kinematics, and nothing jumps") {
  const Armature rig = walker();
  const std::vector<Pose> steps = test::sliding_steps(rig, 61);
  Clip clip{.name = "Keys"};
  for (int frame = 0; frame <= 60; ++frame)
    for (int bone = 0; bone < std::ssize(rig.bones); ++bone) insert_key(clip.keys, rig, steps[frame], {bone}, frame);
  const auto armature = std::make_shared<const Armature>(rig);
  const ClipOnRig plain(std::make_shared<const Clip>(clip), armature);
  Constraint plant = plant_of("LeftHand", "Hips", {180, -80, 980});
  clip.constraints = std::make_shared<const Constraints>(Constraints{{plant}});
  insert_weight_key(clip.keys, "Plant", 10, 0);
  insert_weight_key(clip.keys, "Plant", 30, 1);
  insert_weight_key(clip.keys, "Plant", 50, 0);
  const ClipOnRig played(std::make_shared<const Clip>(clip), armature);
  CHECK(weight_at(plant, clip.keys, 20) == doctest::Approx(0.5));
  for (const int frame : {0, 5, 10, 50, 60}) CHECK(played.at(frame) == plain.at(frame));
  const int hand = bone_of(rig, "LeftHand"), hips = bone_of(rig, "Hips");
  const Pose held = played.at(30);
  CHECK(glm::distance(tail_of(rig, held, hand), at(rig, held, hips, plant.place)) < 0.5);
  CHECK(played.unconstrained_at(30) == plain.at(30));
  // While the constraint's weight rises, the hand moves by about 330 mm in 20 frames, and the body by 2 mm in each
  // frame. So the hand must move in every frame, but never by more than 45 mm.
  glm::dvec3 before = tail_of(rig, played.at(0), hand);
  double most = 0;
  for (int frame = 1; frame <= 60; ++frame) {
    const glm::dvec3 now = tail_of(rig, played.at(frame), hand);
    most = std::max(most, glm::distance(before, now));
    before = now;
  }
  CHECK(most > 5);
  CHECK(most < 45);
  set_weight_interpolation(clip.keys, "Plant", Interpolation::Constant);
  CHECK(weight_at(plant, clip.keys, 29) == 0);
  CHECK(weight_at(plant, clip.keys, 30) == 1);
  CHECK(weight_at(plant, clip.keys, 49) == 1);
}

TEST_CASE("constraints: a target that goes smoothly, in and out of reach, is followed without jumps") {
  const Armature rig = walker();
  test::RandomNumbers random(2);
  const Pose pose = random_pose(rig, random, 0.3);
  const int hand = bone_of(rig, "LeftHand"), lower = bone_of(rig, "LeftForeArm");
  for (const ConstraintKind kind : {ConstraintKind::Plant, ConstraintKind::InverseKinematics}) {
    Constraint constraint{.name = "C", .kind = kind, .bone = "LeftHand", .chain = 3};
    std::optional<Pose> last;
    double elbow = 0, tip = 0;
    for (int step = 0; step <= 1000; ++step) {
      const double t = step * 0.001 * 2 * std::numbers::pi;
      constraint.place =
          glm::dvec3(250 + 450 * std::sin(t), -350 + 100 * std::cos(2 * t), 1250 + 350 * std::sin(3 * t));
      const Pose next = constrained(rig, constraint, pose);
      if (last) {
        tip = std::max(tip, glm::distance(tail_of(rig, next, hand), tail_of(rig, *last, hand)));
        elbow = std::max(elbow, glm::distance(head_of(rig, next, lower), head_of(rig, *last, lower)));
      }
      last = next;
    }
    CAPTURE(static_cast<int>(kind));
    MESSAGE("largest step of the tip ", tip, " mm, of the elbow ", elbow, " mm");
    CHECK(tip < 12);  // the hand's motion in a step, mm; the target moves at most 7.3 mm
    // When a limb becomes straight, its elbow moves like the square root of the missing length: up to 45 mm in a step
    // of 7 mm.
    CHECK(elbow < 60);
  }
}

TEST_CASE("constraints: one waits for another that turns its target, whatever the order of the list is") {
  const Armature rig = walker();
  test::RandomNumbers random(31);
  const Pose pose = random_pose(rig, random, 0.3);
  const int hand = bone_of(rig, "LeftHand"), hips = bone_of(rig, "Hips"), spine = bone_of(rig, "Spine");
  const Constraint aim{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "Spine", .place{200, -300, 2000}},
      plant = plant_of("LeftHand", "Hips", {180, -80, 980}),
      copy{.name = "Copy",
           .kind = ConstraintKind::CopyRotation,
           .bone = "Hips",
           .target = "RightUpLeg",
           .space = RotationSpace::Parent};
  const ConstraintStack first = stack_of(rig, {plant, aim}), second = stack_of(rig, {aim, plant});
  CHECK(first.order() == std::vector<std::size_t>{1, 0});
  CHECK(second.order() == std::vector<std::size_t>{0, 1});
  const Pose both = first.constrained(pose, {}, 0);
  CHECK(both == second.constrained(pose, {}, 0));
  CHECK(glm::distance(tail_of(rig, both, hand), at(rig, both, hips, plant.place)) < 0.5);
  CHECK(degrees_between(tail_of(rig, both, spine) - head_of(rig, both, spine), aim.place - head_of(rig, both, spine)) <
        0.01);
  CHECK(stack_of(rig, {plant, aim, copy}).problem(2) == "");
}

TEST_CASE("constraints: circles and missing bones are refused with one line, and the others hold") {
  const Armature rig = walker();
  const Constraint left = plant_of("LeftHand", "RightHand", {-200, 0, 760});
  Constraint right = plant_of("RightHand", "LeftHand", {200, 0, 760}), own = plant_of("LeftHand", "LeftForeArm", {});
  right.name = "Right";
  own.name = "Own";
  const Constraint aim{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "Spine", .place{200, -300, 2000}},
      gone{.name = "Gone", .kind = ConstraintKind::Aim, .bone = "Tail"},
      bare{.name = "Bare", .kind = ConstraintKind::CopyRotation, .bone = "Spine"};
  const ConstraintStack stack = stack_of(rig, {left, aim, right, own, gone, bare});
  CHECK(stack.problem(0) ==
        "these constraints depend on each other in a cycle: Plant and Right: choose another target, or remove one");
  CHECK(stack.problem(1) == "");
  CHECK(stack.problem(2) ==
        "these constraints depend on each other in a cycle: Right and Plant: choose another target, or remove one");
  CHECK(stack.problem(3) == "the constrained bone moves its own target: Own: choose another target");
  CHECK(stack.problem(4) == "the rig has no bone \"Tail\": Gone: choose another bone, or remove the constraint");
  CHECK(stack.problem(5) == "the constraint has no target: Bare: choose a bone as its target");
  CHECK_THROWS_WITH_AS(stack.require_applied(3),
                       "the constrained bone moves its own target: Own: choose another target", Error);
  CHECK_NOTHROW(stack.require_applied(1));
  const Pose rest = rest_pose(rig);
  CHECK(stack.constrained(rest, {}, 0) == constrained(rig, aim, rest));
}

TEST_CASE("constraints: keys of weights move, mirror and change their speed with the clip") {
  const Armature rig = walker();
  const auto armature = std::make_shared<const Armature>(rig);
  Clip clip{.name = "Keys"};
  Constraint plant = plant_of("LeftHand", "LeftUpLeg", {150, -80, 800});
  plant.keeps_rotation = true;
  plant.rotation = exponential({0.1, 0.5, 0.2});
  Constraint limit{.name = "Limit", .kind = ConstraintKind::LimitRotation, .bone = "RightForeArm"};
  limit.minimum = {-0.1, -0.2, -0.3};
  limit.maximum = {0.4, 0.5, 0.6};
  Constraint aim{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "RightFoot", .place{300, -900, 40}};
  aim.aim = BoneAxis::MinusX;
  clip.constraints = std::make_shared<const Constraints>(Constraints{{plant, limit, aim}});
  insert_weight_key(clip.keys, "Plant", 0, 0.25);
  insert_weight_key(clip.keys, "Plant", 20, 1);
  test::RandomNumbers random(12);
  const Pose pose = random_pose(rig, random, 0.4);
  for (int bone = 0; bone < std::ssize(rig.bones); ++bone) insert_key(clip.keys, rig, pose, {bone}, 0);
  CHECK(frames_of(clip.keys) == std::set<int>{0, 20});
  const auto shared = std::make_shared<const Clip>(clip);
  const Clip mirrored = mirrored_clip(shared, armature);
  const ClipOnRig before(shared, armature), after(std::make_shared<const Clip>(mirrored), armature);
  for (const int frame : {0, 7, 20}) {
    const Pose wanted = flipped(before.at(frame), rig), seen = after.at(frame);
    for (int bone = 0; bone < std::ssize(rig.bones); ++bone) {
      CAPTURE(rig.bones[bone].name);
      CHECK(largest_difference(posed_matrix(rig, wanted, bone), posed_matrix(rig, seen, bone)) < 1e-6);
    }
  }
  CHECK(at_speed(clip, 0.5).keys.weights.at("Plant") == std::map<int, double>{{0, 0.25}, {40, 1}});
  delete_keys(clip.keys, {20});
  CHECK(clip.keys.weights.at("Plant") == std::map<int, double>{{0, 0.25}});
  CHECK(delete_weight_key(clip.keys, "Plant", 0));
  CHECK_FALSE(delete_weight_key(clip.keys, "Plant", 0));
  CHECK(clip.keys.weights.empty());
}

TEST_CASE("constraints: applied, they play as before bit for bit in every frame, and other bones keep their keys") {
  const Armature rig = walker();
  const auto armature = std::make_shared<const Armature>(rig);
  const std::vector<Pose> steps = test::sliding_steps(rig, 40);
  Clip clip{.name = "Keys", .range_start = 0, .range_end = 39};
  for (const int frame : {0, 13, 39})
    for (int bone = 0; bone < std::ssize(rig.bones); ++bone) insert_key(clip.keys, rig, steps[frame], {bone}, frame);
  Constraint off{.name = "Off", .kind = ConstraintKind::Aim, .bone = "RightHand"};
  off.on = false;
  clip.constraints =
      std::make_shared<const Constraints>(Constraints{{plant_of("LeftHand", "Hips", {180, -80, 980}), off}});
  insert_weight_key(clip.keys, "Plant", 5, 0.2);
  insert_weight_key(clip.keys, "Plant", 25, 1);
  const auto shared = std::make_shared<const Clip>(clip);
  const auto applied = std::make_shared<const Clip>(with_constraints_as_keys(shared, armature, 0, 39, no_progress()));
  CHECK(!applied->constraints);
  CHECK(applied->keys.weights.empty());
  CHECK(applied->keys.bones.at("LeftForeArm").size() == 40);
  CHECK(applied->keys.bones.at("RightHand") == clip.keys.bones.at("RightHand"));
  const ClipOnRig before(shared, armature), after(applied, armature);
  for (int frame = 0; frame < 40; ++frame) CHECK(after.at(frame) == before.at(frame));
  CHECK_THROWS_AS(with_constraints_as_keys(applied, armature, 0, 39, no_progress()), Error);
}
