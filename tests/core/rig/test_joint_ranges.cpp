// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_ranges.h"

#include <algorithm>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

#include "core/rig/joint_limits.h"
#include "core/rig_io/rig_templates.h"

using namespace limber;

namespace {

int joint(const std::string& name) {
  const auto all = usual_joints();
  return static_cast<int>(std::find(all.begin(), all.end(), name) - all.begin());
}

double degrees(double radians) { return glm::degrees(radians); }

}  // namespace

TEST_CASE("ranges of motion: joints of the adult template are known by their names, each side alike") {
  const Armature adult = rig_template("adult");
  const auto joints = usual_joints_of(adult);
  int known = 0;
  for (std::size_t b = 0; b < adult.bones.size(); ++b) {
    known += joints[b].has_value();
    if (!joints[b]) continue;
    const JointLimits limits = usual_limits(adult, static_cast<int>(b), *joints[b]);
    // The rest pose is always allowed, and minimum <= maximum.
    Bone bone = adult.bones[b];
    bone.limits = limits;
    CHECK(limit_excess(bone, glm::dquat(1, 0, 0, 0)) == 0);
    CHECK(limits.minimum <= limits.maximum);
    CHECK(limits.twist_minimum <= limits.twist_maximum);
  }
  CHECK(known > std::ssize(adult.bones) / 2);
  const auto named = [&](const std::string& name) { return joints[*adult.find(name)]; };
  for (const std::string part :
       {"Forearm", "Hand", "Thigh", "Shank", "Foot", "Toes", "IndexProximal", "LittleDistal", "ThumbMetacarpal"}) {
    REQUIRE(named("Left" + part));
    CHECK(named("Left" + part) == named("Right" + part));
  }
  CHECK(named("LeftForearm") == joint("Elbow"));
  CHECK(!named("Jaw"));
}

TEST_CASE("ranges of motion: a straight elbow bends forward, a straight knee backward, a bent one on") {
  Armature rig;
  rig.bones.push_back({"UpperArm", -1, {0, 0, 0}, {0, 0, -300}, 0, {}});
  rig.bones.push_back({"Forearm", 0, {0, 0, -300}, {0, 0, -550}, 0, {}});
  for (const auto& [name, front] : {std::pair<const char*, bool>{"Elbow", true}, {"Knee", false}}) {
    const JointLimits limits = usual_limits(rig, 1, joint(name));
    REQUIRE(limits.type == JointLimits::Type::Hinge);
    CHECK(degrees(limits.minimum) == doctest::Approx(0));
    CHECK(degrees(limits.maximum) == doctest::Approx(front ? 150 : 135));
    const glm::dvec3 bent = glm::angleAxis(0.5, limits.axis) * glm::dvec3(0, 0, -250);
    CHECK((bent.y < -50) == front);  // -y is the front
    CHECK(std::abs(bent.y) > 50);
  }
  rig.bones[1].tail = {200, 0, -450};
  const JointLimits bent = usual_limits(rig, 1, joint("Elbow"));
  CHECK((glm::angleAxis(0.5, bent.axis) * glm::dvec3(200, 0, -150)).z > -50);  // it bends further in the same direction
  // A hinge whose axis was set by hand keeps it.
  rig.bones[1].limits = bent;
  rig.bones[1].limits.axis = {1, 0, 0};
  CHECK(usual_limits(rig, 1, joint("Elbow")).axis == glm::dvec3(1, 0, 0));
}

TEST_CASE("ranges of motion: bones of one spine share its range, and a collar bone takes a third of the shoulder's") {
  Armature rig;
  rig.bones.push_back({"Hips", -1, {0, 0, 0}, {0, 0, 100}, 0, {}});
  rig.bones.push_back({"Spine", 0, {0, 0, 100}, {0, 0, 200}, 0, {}});
  rig.bones.push_back({"Spine1", 1, {0, 0, 200}, {0, 0, 300}, 0, {}});
  rig.bones.push_back({"Neck", 2, {0, 0, 300}, {0, 0, 400}, 0, {}});
  rig.bones.push_back({"LeftArm", 2, {100, 0, 300}, {100, 0, 0}, 0, {}});
  const auto joints = usual_joints_of(rig);
  REQUIRE(joints[1] == joint("Spine"));
  CHECK(degrees(usual_limits(rig, 1, *joints[1]).cone) == doctest::Approx(40));
  CHECK(degrees(usual_limits(rig, 1, *joints[1]).twist_maximum) == doctest::Approx(22.5));
  CHECK(degrees(usual_limits(rig, 4, joint("Shoulder")).cone) == doctest::Approx(180));
  rig.bones[4].name = "LeftShoulder";
  rig.bones.push_back({"LeftArm", 4, {100, 0, 300}, {100, 0, 0}, 0, {}});
  rig.bones.push_back({"LeftForeArm", 5, {100, 0, 0}, {100, 0, -200}, 0, {}});
  CHECK(degrees(usual_limits(rig, 5, joint("Shoulder")).cone) == doctest::Approx(120));
}
