// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/inverse_kinematics.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/rig/joint_limits.h"

using namespace limber;

namespace {

constexpr double kPi = std::numbers::pi;

class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}
  double operator()(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  glm::dvec3 direction() {
    glm::dvec3 v;
    do v = {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)};
    while (glm::length(v) > 1 || glm::length(v) < 0.1);
    return glm::normalize(v);
  }

 private:
  std::mt19937 random_;
};

JointLimits any_limits(Chance& chance) {
  const double kind = chance(0, 1);
  if (kind < 0.4)
    return {.type = JointLimits::Type::Hinge,
            .axis = chance.direction(),
            .minimum = chance(-1.5, 0),
            .maximum = chance(0.3, 2.5)};
  if (kind < 0.9)
    return {.type = JointLimits::Type::Ball,
            .cone = chance(0.4, 2.2),
            .twist_minimum = chance(-1.2, -0.1),
            .twist_maximum = chance(0.1, 1.2)};
  return {};
}

Armature any_chain(Chance& chance, int bones) {
  Armature armature;
  glm::dvec3 head(chance(-100, 100), chance(-100, 100), chance(-100, 100));
  for (int b = 0; b < bones; ++b) {
    const glm::dvec3 tail = head + chance(30, 300) * chance.direction();
    armature.bones.push_back({.name = "bone" + std::to_string(b),
                              .parent = b - 1,
                              .head = head,
                              .tail = tail,
                              .limits = any_limits(chance)});
    head = tail;
  }
  return armature;
}

Pose any_legal_pose(Chance& chance, const Armature& armature) {
  Pose pose = rest_pose(armature);
  for (size_t b = 0; b < armature.bones.size(); ++b) {
    const Bone& bone = armature.bones[b];
    const JointLimits& limits = bone.limits;
    if (limits.type == JointLimits::Type::Hinge)
      pose.rotation[b] = exponential(chance(limits.minimum, limits.maximum) * limits.axis);
    if (limits.type == JointLimits::Type::Free) pose.rotation[b] = exponential(chance(0, 3) * chance.direction());
    if (limits.type == JointLimits::Type::Ball) {
      const glm::dvec3 axis = twist_axis(bone), across = glm::normalize(glm::cross(axis, chance.direction()));
      pose.rotation[b] =
          rotation_of({chance(0, limits.cone) * across, chance(limits.twist_minimum, limits.twist_maximum)}, axis);
    }
  }
  return pose;
}

glm::dvec3 tail_of(const Armature& armature, const Pose& pose, int bone) {
  return posed_from_rest(armature, pose)[bone] * armature.bones[bone].tail;
}

double worst_excess(const Armature& armature, const Pose& pose) {
  double worst = 0;
  for (size_t b = 0; b < armature.bones.size(); ++b)
    worst = std::max(worst, limit_excess(armature.bones[b], pose.rotation[b]));
  return worst;
}

bool is_finite(const Pose& pose) {
  bool finite = true;
  for (const glm::dquat& q : pose.rotation)
    finite &= std::isfinite(q.w + q.x + q.y + q.z) && std::abs(glm::length(q) - 1) < 1e-9;
  return finite;
}

}  // namespace

TEST_CASE("inverse kinematics: targets that a legal pose has are reached, and no limit is broken") {
  Chance chance(1);
  int reached = 0, slow = 0;
  constexpr int kTargets = 10000;
  double worst = 0, seconds = 0;
  for (int i = 0; i < kTargets; ++i) {
    const Armature armature = any_chain(chance, 4);
    const glm::dvec3 target = tail_of(armature, any_legal_pose(chance, armature), 3);
    const auto before = std::chrono::steady_clock::now();
    const Reach found = reach(armature, rest_pose(armature), {{.bone = 3, .target = target}});
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    seconds += took;
    slow += took > 1e-3;
    REQUIRE(is_finite(found.pose));
    worst = std::max(worst, worst_excess(armature, found.pose));
    CHECK(found.distance == doctest::Approx(glm::distance(tail_of(armature, found.pose, 3), target)).epsilon(1e-6));
    reached += found.distance < 0.1;
  }
  MESSAGE(reached, " of ", kTargets, " reached, ", 1e6 * seconds / kTargets, " us each, ", slow,
          " over 1 ms, largest excess ", worst);
  CHECK(reached >= 0.99 * kTargets);
  CHECK(worst < 1e-6);
}

TEST_CASE("inverse kinematics: what lies out of reach comes as near as it can, and is said" *
          doctest::test_suite("slow")) {
  Chance chance(2);
  double furthest = 0;
  int said = 0;
  constexpr int kTargets = 10000;
  for (int i = 0; i < kTargets; ++i) {
    Armature armature = any_chain(chance, 4);
    for (Bone& bone : armature.bones) bone.limits = {};
    double length = 0;
    for (const Bone& bone : armature.bones) length += glm::distance(bone.head, bone.tail);
    const glm::dvec3 base = armature.bones[0].head, off = length * chance(1.01, 5) * chance.direction();
    const Reach found = reach(armature, rest_pose(armature), {{.bone = 3, .target = base + off}});
    REQUIRE(is_finite(found.pose));
    said += !found.reached;
    furthest = std::max(furthest, (found.distance - (glm::length(off) - length)) / length);
  }
  MESSAGE("furthest ", furthest, " of the length beyond the nearest point");
  CHECK(said == kTargets);
  CHECK(furthest < 1e-3);
}

TEST_CASE("inverse kinematics: out of reach within limits, a small step of the target is a small step of the pose") {
  Chance chance(3);
  double largest = 0;
  int jumps = 0, steps = 0;
  for (int i = 0; i < 100; ++i) {
    const Armature armature = any_chain(chance, 4);
    const glm::dvec3 base = armature.bones[0].head, off = 1500.0 * chance.direction(),
                     along = glm::cross(off, chance.direction()) / 1000.0;
    Pose pose = reach(armature, rest_pose(armature), {{.bone = 3, .target = base + off}}).pose;
    for (int step = 1; step <= 10; ++step, ++steps) {
      const Reach next = reach(armature, pose, {{.bone = 3, .target = base + off + double(step) * along}});
      CHECK(worst_excess(armature, next.pose) < 1e-6);
      const double moved = glm::distance(tail_of(armature, pose, 3), tail_of(armature, next.pose, 3));
      largest = std::max(largest, moved);
      jumps += moved > 60;
      pose = next.pose;
    }
  }
  MESSAGE("largest step of the tip ", largest, " mm, ", jumps, " jumps in ", steps, " steps");
  CHECK(jumps <= steps / 50);
}

TEST_CASE("inverse kinematics: out of reach within limits, no pose near the one found comes nearer" *
          doctest::test_suite("slow")) {
  Chance chance(4);
  int reached = 0, nearer = 0, slow = 0;
  constexpr int kTargets = 10000;
  double seconds = 0;
  for (int i = 0; i < kTargets; ++i) {
    const Armature armature = any_chain(chance, 4);
    double length = 0;
    for (const Bone& bone : armature.bones) length += glm::distance(bone.head, bone.tail);
    const glm::dvec3 target = armature.bones[0].head + length * chance(1.01, 3) * chance.direction();
    const auto before = std::chrono::steady_clock::now();
    const Reach found = reach(armature, rest_pose(armature), {{.bone = 3, .target = target}});
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    seconds += took;
    slow += took > 1e-3;
    REQUIRE(is_finite(found.pose));
    CHECK(worst_excess(armature, found.pose) < 1e-6);
    reached += found.reached;
    for (int k = 0; k < 20; ++k) {
      Pose other = found.pose;
      for (size_t b = 0; b < 4; ++b)
        other.rotation[b] =
            within_limits(armature.bones[b], exponential(chance(0, 0.02) * chance.direction()) * other.rotation[b]);
      if (glm::distance(tail_of(armature, other, 3), target) < found.distance - 1e-3 * length) {
        ++nearer;
        break;
      }
    }
  }
  MESSAGE("", 1e6 * seconds / kTargets, " us each, ", slow, " over 1 ms, ", nearer, " with a nearer pose beside them");
  CHECK(reached == 0);
  CHECK(nearer < kTargets / 1000);
}

TEST_CASE("inverse kinematics: a pinned foot stays while the hip is dragged, and a bent knee points to its pole") {
  Armature leg;
  leg.bones = {{.name = "Pelvis", .head = {0, 0, 900}, .tail = {0, 0, 1000}},
               {.name = "Thigh", .parent = 0, .head = {0, 0, 900}, .tail = {0, 0, 480}},
               {.name = "Shin", .parent = 1, .head = {0, 0, 480}, .tail = {0, 0, 80}}};
  ReachSettings settings;
  settings.move_root = true;
  const Reach crouched =
      reach(leg, rest_pose(leg), {{.bone = 0, .target = {0, 0, 900}}, {.bone = 2, .target = {0, 0, 80}, .weight = 10}},
            settings);
  CHECK(crouched.reached);
  CHECK(glm::distance(tail_of(leg, crouched.pose, 2), glm::dvec3(0, 0, 80)) < 0.02);
  CHECK(glm::distance(tail_of(leg, crouched.pose, 0), glm::dvec3(0, 0, 900)) < 0.02);

  ReachSettings towards;
  for (const glm::dvec3 pole : {glm::dvec3(0, -1000, 500), glm::dvec3(800, 300, 500)}) {
    towards.pole = pole;
    const Reach bent = reach(leg, rest_pose(leg), {{.bone = 2, .target = {50, -30, 300}, .chain = 2}}, towards);
    CHECK(bent.reached);
    const glm::dvec3 knee = posed_from_rest(leg, bent.pose)[2] * leg.bones[2].head, hip = leg.bones[1].head;
    const glm::dvec3 along = glm::normalize(glm::dvec3(50, -30, 300) - hip);
    auto across = [&](const glm::dvec3& p) { return glm::normalize(p - hip - along * glm::dot(p - hip, along)); };
    CHECK(glm::dot(across(knee), across(pole)) > 0.999);
  }
}

TEST_CASE("inverse kinematics: bones above the chain stay, and the pose given is kept where it already reaches") {
  Chance chance(5);
  const Armature armature = any_chain(chance, 6);
  const Pose pose = any_legal_pose(chance, armature);
  const glm::dvec3 here = tail_of(armature, pose, 5);
  const Reach same = reach(armature, pose, {{.bone = 5, .target = here, .chain = 3}});
  CHECK(same.reached);
  for (int b = 0; b < 6; ++b) CHECK(std::abs(glm::dot(same.pose.rotation[b], pose.rotation[b])) > 1 - 1e-12);
  const Reach near = reach(armature, pose, {{.bone = 5, .target = here + glm::dvec3(5, 0, 0), .chain = 3}});
  for (int b = 0; b < 3; ++b) CHECK(near.pose.rotation[b] == pose.rotation[b]);
}

TEST_CASE("inverse kinematics: an unknown bone or a target that is no place is refused") {
  Chance chance(6);
  const Armature armature = any_chain(chance, 2);
  CHECK_THROWS_AS(reach(armature, rest_pose(armature), {{.bone = 7}}), Error);
  CHECK_THROWS_AS(reach(armature, rest_pose(armature), {{.bone = 1, .target = {NAN, 0, 0}}}), Error);
}
