// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/rig_templates.h"

#include <set>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/rig/joint_limits.h"
#include "core/rig/mirror.h"

namespace limber {

TEST_CASE("rig templates: each is a rig with names of its own and parents first") {
  for (const RigTemplate& one : rig_templates()) {
    CAPTURE(one.name);
    const Armature rig = rig_template(one.name);
    CHECK_NOTHROW(check_armature(rig, one.name));
    std::set<std::string> names;
    int roots = 0;
    for (int b = 0; b < std::ssize(rig.bones); ++b) {
      CHECK(names.insert(rig.bones[b].name).second);
      CHECK(rig.bones[b].parent < b);
      CHECK(glm::distance(rig.bones[b].head, rig.bones[b].tail) > 1);
      roots += rig.bones[b].parent < 0;
    }
    CHECK(roots == 1);
  }
}

TEST_CASE("rig templates: the two sides are mirror images of each other, limits included") {
  for (const char* name : {"adult", "child", "quadruped"}) {
    CAPTURE(name);
    const Armature rig = rig_template(name);
    const std::vector<int> pairs = mirror_pairs(rig);
    const glm::dvec3 across(-1, 1, 1);
    int paired = 0;
    for (int b = 0; b < std::ssize(rig.bones); ++b) {
      const Bone &bone = rig.bones[b], &other = rig.bones[pairs[b]];
      CAPTURE(bone.name);
      CHECK(glm::distance(bone.head * across, other.head) < 0.05);
      CHECK(glm::distance(bone.tail * across, other.tail) < 0.05);
      CHECK(bone.limits.type == other.limits.type);
      CHECK(bone.limits.minimum == doctest::Approx(other.limits.minimum).epsilon(0.001));
      CHECK(bone.limits.maximum == doctest::Approx(other.limits.maximum).epsilon(0.001));
      if (bone.limits.type == JointLimits::Type::Hinge)
        CHECK(glm::distance(bone.limits.axis * -across, other.limits.axis) < 1e-3);
      paired += pairs[b] != b;
    }
    CHECK(paired >= 14);
  }
}

TEST_CASE("rig templates: limits are ranges that hold rest, about unit axes") {
  for (const RigTemplate& one : rig_templates()) {
    const Armature rig = rig_template(one.name);
    int limited = 0;
    for (const Bone& bone : rig.bones) {
      CAPTURE(one.name + " " + bone.name);
      const JointLimits& limits = bone.limits;
      if (limits.type == JointLimits::Type::Hinge) {
        CHECK(glm::length(limits.axis) == doctest::Approx(1).epsilon(1e-4));
        CHECK(limits.minimum <= 0);
        CHECK(limits.maximum >= 0);
        CHECK(limits.maximum - limits.minimum < 3.2);
      }
      if (limits.type == JointLimits::Type::Ball) {
        CHECK(limits.cone > 0);
        CHECK(limits.twist_minimum <= 0);
        CHECK(limits.twist_maximum >= 0);
      }
      CHECK(limit_excess(bone, glm::dquat(1, 0, 0, 0)) < 1e-9);
      limited += limits.type != JointLimits::Type::Free;
    }
    CHECK(limited >= std::ssize(rig.bones) * 2 / 3);
  }
}

TEST_CASE("rig templates: an unknown name is refused with those there are") {
  CHECK_THROWS_AS(rig_template("octopus"), Error);
}

}  // namespace limber
