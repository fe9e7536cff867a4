// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/pose_library.h"

#include <doctest/doctest.h>

using namespace limber;

TEST_CASE(
    "pose library: a named pose gives its bones back, and leaves alone what it does not name or is not asked for") {
  const Armature rig{{{"Root", -1, {0, 0, 0}, {0, 0, 10}},
                      {"Upper", 0, {0, 0, 10}, {0, 0, 20}},
                      {"Lower", 1, {0, 0, 20}, {0, 0, 30}}}};
  Pose pose = rest_pose(rig);
  for (int bone = 0; bone < 3; ++bone) pose.rotation[bone] = glm::angleAxis(0.1 * (bone + 1), glm::dvec3(1, 0, 0));
  pose.root_translation = {1, 2, 3};
  const NamedPose all = named_pose({}, "Reach", rig, pose, {0, 1, 2}), lower = named_pose({}, "Curl", rig, pose, {2});

  CHECK(taken_from(all, rig, rest_pose(rig), {0, 1, 2}) == pose);
  const Pose one = taken_from(all, rig, rest_pose(rig), {1});
  CHECK(one.rotation[1] == pose.rotation[1]);
  CHECK(one.rotation[2] == glm::dquat(1, 0, 0, 0));
  CHECK(one.root_translation == glm::dvec3(0));
  const Pose curled = taken_from(lower, rig, rest_pose(rig), {0, 1, 2});
  CHECK(curled.rotation[2] == pose.rotation[2]);
  CHECK(curled.rotation[0] == glm::dquat(1, 0, 0, 0));
  CHECK(curled.root_translation == glm::dvec3(0));

  // On another rig, bones take the rotations that the pose has for their names.
  const Armature other{{{"Lower", -1, {0, 0, 0}, {0, 0, 10}}}};
  CHECK(taken_from(all, other, rest_pose(other), {0}).rotation[0] == pose.rotation[2]);

  const PoseLibrary library{std::make_shared<const NamedPose>(all)};
  CHECK(named_pose(library, "Reach", rig, pose, {0}).name == "Reach 2");
}
