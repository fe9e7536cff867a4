// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/clip.h"

#include <random>

#include <doctest/doctest.h>

namespace limber::test {

namespace {

std::shared_ptr<const Armature> two_bones() {
  Armature armature;
  armature.bones = {{"Upper", -1, {0, 0, 30}, {0, 0, 0}}, {"Fore", 0, {0, 0, 0}, {0, 0, -30}}};
  return std::make_shared<const Armature>(armature);
}

// Returns a motion in which joint 1 bends about x by one degree per frame.
std::shared_ptr<const Motion> bending(int frames) {
  Motion motion;
  motion.joints = {{.name = "Upper"},
                   {.name = "Fore",
                    .parent = 0,
                    .offset = {0, -30, 0},
                    .channels = {BvhChannel::Xrotation},
                    .end_site = glm::dvec3(0, -30, 0)}};
  motion.channel_count = 1;
  motion.frame_count = frames;
  for (int frame = 0; frame < frames; ++frame) motion.values.push_back(static_cast<float>(frame));
  return std::make_shared<const Motion>(motion);
}

double bend(const Pose& pose) { return glm::degrees(2 * std::atan2(pose.rotation[1].x, pose.rotation[1].w)); }
glm::dquat bent(double degrees) { return glm::angleAxis(glm::radians(degrees), glm::dvec3(1, 0, 0)); }

}  // namespace

TEST_CASE("clip: frames outside the motion hold its ends, and what is cut off is not seen") {
  Clip clip = clip_of(bending(61), "bending", 100);
  CHECK(clip.end() == 160);
  const auto at = [&](int frame) { return bend(ClipOnRig(std::make_shared<const Clip>(clip), two_bones()).at(frame)); };
  CHECK(at(-5) == doctest::Approx(0));
  CHECK(at(130) == doctest::Approx(30));
  CHECK(at(1000) == doctest::Approx(60));
  clip.first = 10;
  clip.last = 40;
  CHECK(at(100) == doctest::Approx(10));
  CHECK(at(120) == doctest::Approx(30));
  CHECK(at(200) == doctest::Approx(40));
}

TEST_CASE("clip: keys alone go from one to the next by slerp and hold outside") {
  Clip clip;
  clip.keys.bones["Fore"] = {{10, bent(20)}, {20, bent(80)}};
  clip.keys.root = {{0, {1, 2, 3}}, {4, {3, 2, 1}}};
  const ClipOnRig on_rig(std::make_shared<const Clip>(clip), two_bones());
  for (const auto& [frame, degrees] :
       {std::pair{-7, 20.0}, {10, 20.0}, {15, 50.0}, {19, 74.0}, {20, 80.0}, {500, 80.0}})
    CHECK(bend(on_rig.at(frame)) == doctest::Approx(degrees));
  CHECK(on_rig.at(10).rotation[1] == bent(20));
  CHECK(glm::length(on_rig.at(1).root_translation - glm::dvec3(1.5, 2, 2.5)) < 1e-12);
}

TEST_CASE("clip: the motion goes through its keys exactly and keeps its own course between them") {
  Clip clip = clip_of(bending(61), "bending");
  clip.keys.bones["Fore"] = {{10, bent(40)}, {30, bent(30)}};
  const ClipOnRig on_rig(std::make_shared<const Clip>(clip), two_bones());
  CHECK(on_rig.at(10).rotation[1] == bent(40));
  CHECK(on_rig.at(30).rotation[1] == bent(30));
  CHECK(bend(on_rig.at(20)) == doctest::Approx(20 + 15));  // the offset of 30 degrees fades to 0 between the keys
  CHECK(bend(on_rig.at(0)) == doctest::Approx(0 + 30));
  CHECK(bend(on_rig.at(50)) == doctest::Approx(50));
}

TEST_CASE("clip: keys that say what the motion does change nothing, for any motion") {
  std::mt19937 random(5);
  const auto angle = [&] { return static_cast<float>(static_cast<int>(random() % 360) - 180); };
  Motion motion = *bending(20);
  for (float& value : motion.values) value = angle();
  Clip clip = clip_of(std::make_shared<const Motion>(motion), "random");
  const auto rig = two_bones();
  const ClipOnRig plain(std::make_shared<const Clip>(clip), rig);
  for (int frame : {2, 3, 11}) insert_key(clip.keys, *rig, plain.at(frame), {0, 1}, frame);
  const ClipOnRig keyed(std::make_shared<const Clip>(clip), rig);
  for (int frame = 0; frame < 20; ++frame)
    CHECK(std::abs(glm::dot(plain.at(frame).rotation[1], keyed.at(frame).rotation[1])) ==
          doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("clip: what matches nothing is said, and the rig stays at rest") {
  Armature other;
  other.bones = {{"Wheel", -1, {0, 0, 0}, {1, 0, 0}}};
  const ClipOnRig on_rig(std::make_shared<const Clip>(clip_of(bending(5), "bending")),
                         std::make_shared<const Armature>(other));
  CHECK(on_rig.retarget() == nullptr);
  CHECK(on_rig.problem().find("no joint name of the motion is recognised") != std::string::npos);
  CHECK(on_rig.at(3) == rest_pose(other));
}

TEST_CASE(
    "keys: moved ones replace what stands where they arrive, copies leave theirs behind, deletion leaves no empty "
    "bone") {
  Keys keys;
  keys.bones["Fore"] = {{1, bent(1)}, {2, bent(2)}, {5, bent(5)}};
  keys.bones["Upper"] = {{1, bent(7)}};
  move_keys(keys, {{1, 2}, {2, 3}});
  CHECK(keys.bones["Fore"] == std::map<int, glm::dquat>{{2, bent(1)}, {3, bent(2)}, {5, bent(5)}});
  CHECK(keys.bones["Upper"] == std::map<int, glm::dquat>{{2, bent(7)}});
  copy_keys(keys, {{2, 9}});
  CHECK(frames_of(keys) == std::set<int>{2, 3, 5, 9});
  delete_keys(keys, {2, 9});
  CHECK_FALSE(keys.bones.contains("Upper"));
  CHECK(frames_of(keys) == std::set<int>{3, 5});
  CHECK(delete_key(keys, *two_bones(), {1}, 3));
  CHECK_FALSE(delete_key(keys, *two_bones(), {1}, 3));
}

}  // namespace limber::test
