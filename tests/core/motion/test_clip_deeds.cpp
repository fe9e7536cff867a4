// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests edits of whole clips: mirroring, speed and baking.
#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/clip_speed.h"
#include "core/motion/key_curve.h"
#include "core/motion/mirror_clip.h"
#include "core/motion/motion_edit.h"
#include "core/motion/recorded_clip.h"
#include "core/rig/mirror.h"
#include "tests/support/sliding_walker.h"

namespace limber::test {

namespace {

constexpr int kFrames = 90;

// A walker that turns, sways and travels, with keys of every kind on top.
//   askew  true: the body does not face along an axis
struct Take {
  explicit Take(bool askew = false, bool with_motion = true) {
    Armature body = walker();
    if (askew)
      for (Bone& bone : body.bones)
        for (glm::dvec3* p : {&bone.head, &bone.tail}) *p = glm::angleAxis(0.6, glm::dvec3(0, 0, 1)) * *p;
    rig = std::make_shared<const Armature>(body);
    std::vector<Pose> poses = sliding_steps(body, kFrames, 0.05);
    for (int f = 0; f < kFrames; ++f) {
      poses[f].rotation[0] = glm::angleAxis(0.01 * f, glm::dvec3(0, 0, 1));
      poses[f].root_translation.x = 40 * std::sin(0.1 * f);
    }
    if (with_motion)
      clip =
          clip_of(std::make_shared<const Motion>(motion_of_poses(body, kFrames, 30, [&](int f) { return poses[f]; })),
                  "take", 10);
    else clip = {.name = "take", .range_end = kFrames - 1};
    clip.retarget.travel = Travel::Free;
    const auto turned = [](double angle, const glm::dvec3& axis) {
      return glm::angleAxis(angle, glm::normalize(axis));
    };
    clip.keys.bones["LeftArm"] = {
        {12, turned(0.4, {1, 2, 0})}, {40, turned(1.2, {0, 1, 1})}, {70, turned(-0.3, {1, 0, 0})}};
    clip.keys.bones["Spine"] = {{16, turned(0.2, {0, 1, 0})}, {60, turned(0.5, {1, 1, 1})}};
    clip.keys.root = {{12, {1, 2, 3}}, {30, {30, -80, 4}}, {54, {80, -300, 20}}, {76, {60, -400, 10}}};
    for (const int frame : {12, 40})
      set_shape(clip.keys, "LeftArm", frame,
                {Interpolation::Bezier, HandleKind::Free, {0.01, 0.02, -0.01}, {0.03, -0.01, 0.02}});
    for (const int frame : {12, 30, 54}) set_root_shape(clip.keys, frame, {Interpolation::Bezier, HandleKind::Clamped});
    clip.markers = {{20, "step"}};
  }
  ClipOnRig on_rig(const Clip& of) const { return {std::make_shared<const Clip>(of), rig}; }
  ClipOnRig on_rig() const { return on_rig(clip); }

  std::shared_ptr<const Armature> rig;
  Clip clip;
};

// Returns the largest angle between two poses' rotations, degrees.
double degrees_apart(const Pose& a, const Pose& b) {
  double most = 0;
  for (std::size_t bone = 0; bone < a.rotation.size(); ++bone)
    most = std::max(most, glm::degrees(glm::length(turn_between(a.rotation[bone], b.rotation[bone]))));
  return most;
}
double mm_apart(const Pose& a, const Pose& b) { return glm::distance(a.root_translation, b.root_translation); }

}  // namespace

TEST_CASE("mirrored clips: every frame plays the mirrored pose, and twice gives the first back") {
  for (const bool askew : {false, true})
    for (const bool with_motion : {false, true}) {
      CAPTURE(askew);
      CAPTURE(with_motion);
      const Take take(askew, with_motion);
      const Clip mirrored = mirrored_clip(std::make_shared<const Clip>(take.clip), take.rig);
      CHECK(mirrored.keys.bones.contains("RightArm"));
      CHECK_FALSE(mirrored.keys.bones.contains("LeftArm"));
      CHECK(mirrored.keys.bones.contains("Spine"));
      CHECK(mirrored.markers == take.clip.markers);
      const Clip twice = mirrored_clip(std::make_shared<const Clip>(mirrored), take.rig);
      const ClipOnRig before = take.on_rig(), after = take.on_rig(mirrored), again = take.on_rig(twice);
      double moves = 0;
      for (int frame = 0; frame <= 110; ++frame) {
        const Pose pose = before.at(frame), wanted = flipped(pose, *take.rig);
        CHECK(degrees_apart(after.at(frame), wanted) < 1e-6);
        CHECK(mm_apart(after.at(frame), wanted) < 1e-6);
        CHECK(degrees_apart(again.at(frame), pose) < 1e-6);
        CHECK(mm_apart(again.at(frame), pose) < 1e-6);
        moves = std::max(moves, degrees_apart(after.at(frame), pose));
      }
      CHECK(moves > 20);  // degrees: the mirror image does differ
    }
}

TEST_CASE("clip speed: a clip played twice as fast has every second pose, and its keys stay where they were") {
  const Take take;
  const Clip fast = at_speed(take.clip, 2);
  CHECK(fast.rate == take.clip.rate);
  CHECK(fast.motion->frame_count == kFrames / 2);
  CHECK(fast.start == 10);
  CHECK(fast.range_start == 10);
  CHECK(fast.range_end == fast.end());
  CHECK(fast.end() == 54);
  CHECK(fast.keys.bones.at("LeftArm").contains(25));  // the key of frame 40 is now at 10 + (40 - 10) / 2
  CHECK(fast.markers[0].frame == 15);
  const ClipOnRig before = take.on_rig(), after = take.on_rig(fast);
  for (int frame = 11; frame <= 42; ++frame) {
    // Every key has an even frame, so its frame in the fast clip is whole.
    const Pose pose = after.at(frame), wanted = before.at(10 + 2 * (frame - 10));
    CHECK(degrees_apart(pose, wanted) < 1e-4);
    CHECK(mm_apart(pose, wanted) < 1e-3);
  }
  const Clip slow = at_speed(take.clip, 0.5);
  CHECK(slow.motion->frame_count == 2 * kFrames - 1);
  const ClipOnRig slowed = take.on_rig(slow);
  for (int frame = 10; frame < 10 + kFrames; ++frame) {
    CHECK(degrees_apart(slowed.at(10 + 2 * (frame - 10)), before.at(frame)) < 1e-4);
    CHECK(mm_apart(slowed.at(10 + 2 * (frame - 10)), before.at(frame)) < 1e-3);
  }
  // The slow clip has the pose halfway between two frames of the motion, by slerp.
  const Pose a = before.base_at(50), b = before.base_at(51), middle = slowed.base_at(10 + 2 * 40 + 1);
  for (std::size_t bone = 0; bone < a.rotation.size(); ++bone)
    CHECK(glm::length(turn_between(middle.rotation[bone], glm::slerp(a.rotation[bone], b.rotation[bone], 0.5))) < 1e-3);
  for (const double factor : {0.0, -1.0, 1e9, std::nan("")}) CHECK_THROWS_AS(at_speed(take.clip, factor), Error);
}

TEST_CASE("clip speed: poses are resampled by slerp from the first on") {
  const Armature rig = walker();
  const std::vector<Pose> poses = sliding_steps(rig, 31, 0.05);
  CHECK(at_speed(poses, 1) == poses);
  CHECK(at_speed(poses, 3).size() == 11);
  CHECK(at_speed(poses, 3)[7] == poses[21]);
  const std::vector<Pose> slow = at_speed(poses, 0.25);
  CHECK(slow.size() == 121);
  for (std::size_t bone = 0; bone < poses[0].rotation.size(); ++bone) {
    const glm::dvec3 whole = turn_between(poses[4].rotation[bone], poses[5].rotation[bone]),
                     part = turn_between(poses[4].rotation[bone], slow[17].rotation[bone]);
    CHECK(glm::distance(whole / 4.0, part) < 1e-9);
  }
  CHECK(at_speed(std::vector<Pose>{}, 2).empty());
}

TEST_CASE("baked clips: what plays is the same, without keys") {
  for (const bool askew : {false, true})
    for (const bool with_motion : {false, true}) {
      const Take take(askew, with_motion);
      Clip clip = take.clip;
      clip.range_start = 14;
      clip.range_end = 80;
      const Clip baked = baked_clip(std::make_shared<const Clip>(clip), take.rig);
      CHECK(baked.keys.empty());
      CHECK(baked.motion->frame_count == 67);
      CHECK(baked.range_start == 14);
      CHECK(baked.range_end == 80);
      CHECK(baked.markers == clip.markers);
      const ClipOnRig before = take.on_rig(clip), after = take.on_rig(baked);
      CHECK(after.problem() == "");
      for (int frame = 14; frame <= 80; ++frame) {
        CHECK(glm::radians(degrees_apart(after.at(frame), before.at(frame))) < 1e-6);
        CHECK(mm_apart(after.at(frame), before.at(frame)) < 1e-3);
      }
    }
}

}  // namespace limber::test
