// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/limit_check.h"

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

using namespace limber;

TEST_CASE("limit check: joints without limits are never called within") {
  Armature rig;
  for (int b = 0; b < 3; ++b)
    rig.bones.push_back({.name = std::string(1, static_cast<char>('A' + b)),
                         .parent = b - 1,
                         .head = {0, 0, 100.0 * b},
                         .tail = {0, 0, 100.0 * b + 100}});
  Pose pose = rest_pose(rig);
  const auto words = [&] { return words_of(check_limits(rig, pose, 1e-6), rig); };
  pose.rotation[1] = glm::angleAxis(3.0, glm::dvec3(1, 0, 0));
  CHECK(words() == "the rig has none");
  pose.rotation[1] = {1, 0, 0, 0};
  CHECK(words() == "the rig has none");

  const auto hinge = [&](int b) {
    rig.bones[b].limits = {.type = JointLimits::Type::Hinge, .axis = {1, 0, 0}, .minimum = 0, .maximum = 1};
  };
  hinge(1);
  CHECK(words() == "1 within, 1 without limits");
  hinge(2);  // bone 2 is the root: without limits it does not count as a joint
  CHECK(words() == "all within");
  pose.rotation[2] = glm::angleAxis(1.5, glm::dvec3(1, 0, 0));
  CHECK(words() == "C is beyond");
  pose.rotation[1] = glm::angleAxis(1.25, glm::dvec3(1, 0, 0));
  CHECK(words() == "B and 1 more are beyond");
  const LimitCheck check = check_limits(rig, pose, 1e-6);
  CHECK(check.beyond == 2);
  CHECK(check.worst == 2);
  CHECK(check.excess == doctest::Approx(0.5));
}
