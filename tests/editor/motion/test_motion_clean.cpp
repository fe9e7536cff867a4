// SPDX-License-Identifier: AGPL-3.0-or-later
// Cleans clips in the editor. The played clip equals the computed one, and undo restores the old clip.
#include <doctest/doctest.h>

#include "core/motion/clean_motion.h"
#include "core/motion/motion_edit.h"
#include "core/motion/pose_filter.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "tests/editor/small_editor.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using namespace limber::test;
using namespace limber::editor;

namespace {

constexpr int kFrames = 120, kStart = 5;
constexpr double kRate = 60;

// The editor with a walker and a clip in which its feet slide. The clip begins at frame 5.
struct WalkerEditor : SmallEditor {
  explicit WalkerEditor(std::vector<Pose> shown = sliding_steps(walker(), kFrames, 0.02))
      : SmallEditor({1280, 720}, {}, false),
        poses(std::move(shown)) {
    Document document = small_body();
    document.armature = std::make_shared<const Armature>(rig);
    Clip clip = clip_for(
        document,
        std::make_shared<const Motion>(motion_of_poses(rig, kFrames, kRate, [&](int frame) { return poses[frame]; })),
        "steps", kStart);
    add_clip(document, std::move(clip));
    editor->history->reset(std::move(document), "Open walker");
    editor->project->name = "walker";
    frame_all(*editor, false);
    play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
  }

  // Returns the poses of the shown clip, from its first frame on.
  std::vector<Pose> played() {
    std::vector<Pose> all;
    const ClipOnRig* clip = clip_on_rig(*editor);
    REQUIRE(clip);
    CHECK(clip->problem() == "");
    for (int frame = 0; frame < kFrames; ++frame) all.push_back(clip->at(kStart + frame));
    return all;
  }
  double largest_slide(const std::vector<Plant>& plants, const std::vector<Pose>& of) const {
    double most = 0;
    for (const Plant& plant : plants) most = std::max(most, error_of(plant, rig, limbs, of).slide);
    return most;
  }

  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  const std::vector<Pose> poses;
};

// Returns the largest distance of a limb's tip between two lists of poses, mm.
double largest_distance(const Armature& rig, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& a,
                        const std::vector<Pose>& b) {
  double most = 0;
  for (std::size_t f = 0; f < a.size(); ++f)
    for (const PlantedLimb& limb : limbs)
      most = std::max(
          most, glm::distance(place_of(limb, PlantPoint::Tip, rig, a[f]), place_of(limb, PlantPoint::Tip, rig, b[f])));
  return most;
}

}  // namespace

TEST_CASE("cleaning clips: feet stand, the new clip plays what was computed, and undo gives back the old one") {
  WalkerEditor test;
  const std::vector<Pose> before = test.played();
  CHECK(largest_distance(test.rig, test.limbs, before, test.poses) < 0.01);
  const auto wanted = clean_motion(test.rig, test.limbs, smoothed(before, kRate, 6), kRate, true, {}, 0.15);
  REQUIRE(wanted.plants.size() >= 4);
  CHECK(test.largest_slide(wanted.plants, before) > 10);

  const Document old = test.editor->document();
  test.play("click \"Motion/Clip/Clean clip...\"\n wait-idle\n key Return\n wait-job\n wait-idle");
  REQUIRE(test.editor->document().clips.size() == 2);
  CHECK(test.fact("clip") == "steps clean");
  CHECK(test.editor->document().frame == old.frame);
  const std::vector<Pose> after = test.played();
  CHECK(largest_distance(test.rig, test.limbs, after, wanted.poses) < 0.05);
  CHECK(test.largest_slide(wanted.plants, after) < 2);

  test.play("key Ctrl+Z\n wait-idle");
  CHECK(test.editor->document().clips == old.clips);
  CHECK(*test.editor->document().pose == *old.pose);
  test.play("key Shift+Ctrl+Z\n wait-idle");
  CHECK(largest_distance(test.rig, test.limbs, test.played(), after) == 0);
}

TEST_CASE("cleaning clips: feet of a body that root motion keeps in place are planted as it travels") {
  WalkerEditor test;
  const auto wanted = clean_motion(test.rig, test.limbs, smoothed(test.played(), kRate, 6), kRate, true, {}, 0.15);
  REQUIRE(wanted.plants.size() >= 4);
  for (const Travel travel : {Travel::Locked, Travel::InPlace}) {
    choose_clip(*test.editor, 0);
    edit_clip(*test.editor, "Root motion", PoseThen::FromClip, [&](Clip& clip) { clip.retarget.travel = travel; });
    test.play("click \"Motion/Clip/Clean clip...\"\n wait-idle\n key Return\n wait-job\n wait-idle");
    CHECK(test.fact("toast").find("No standing foot") == std::string::npos);
    CHECK(shown_clip(test.editor->document())->retarget.travel == travel);
    if (travel == Travel::Locked)
      for (const Pose& pose : test.played()) CHECK(glm::length(pose.root_translation) < 1e-6);
    // With free root motion, the body travels and the feet stand still.
    edit_clip(*test.editor, "Root motion", PoseThen::FromClip,
              [&](Clip& clip) { clip.retarget.travel = Travel::Free; });
    CHECK(test.largest_slide(wanted.plants, test.played()) < 2);
    CHECK(largest_distance(test.rig, test.limbs, test.played(), wanted.poses) < 0.05);
  }
}

TEST_CASE("cleaning clips: a hand comes to the cross-hair and stays there, with the clip's keys kept in the motion") {
  WalkerEditor test;
  // Sets a key of the spine, which carries the head and the arms.
  go_to_frame(*test.editor, kStart + 60);
  edit_clip(*test.editor, "Key", PoseThen::FromClip,
            [&](Clip& clip) { clip.keys.bones["Spine"][kStart + 60] = glm::angleAxis(0.2, glm::dvec3(0, 0, 1)); });
  const std::vector<Pose> before = test.played();
  const PlantedLimb& right = test.limbs[3];
  REQUIRE(right.name == "right hand");
  const glm::dvec3 shoulder = test.rig.bones[right.upper].head,
                   hand = place_of(right, PlantPoint::Tip, test.rig, before[60]);
  test.editor->views->cross_hair = hand + 0.3 * (shoulder - hand) + glm::dvec3(0, -60, 0);
  test.play(
      "click \"Motion/Clip/Hold a hand or foot...\"\n wait-idle\n click \"Hold at/Cross-hair\"\n click \"Result/New "
      "clip\"\n double-click \"To frame/value\"\n key Ctrl+A\n type 75\n key Tab\n wait-idle\n click Hold\n wait-job\n "
      "wait-idle");
  REQUIRE(test.editor->document().clips.size() == 2);
  CHECK(test.fact("clip") == "steps held");
  CHECK(shown_clip(test.editor->document())->keys.empty());
  const std::vector<Pose> after = test.played();
  for (int f = 60; f <= 70; ++f)
    CHECK(glm::distance(place_of(right, PlantPoint::Tip, test.rig, after[f]), test.editor->views->cross_hair) < 3);
  // Frames far from the hold and the other limbs are unchanged.
  for (const int f : {0, 30, 100, kFrames - 1})
    CHECK(glm::distance(place_of(right, PlantPoint::Tip, test.rig, after[f]),
                        place_of(right, PlantPoint::Tip, test.rig, before[f])) < 0.05);
  const PlantedLimb& left = test.limbs[2];
  for (int f = 0; f < kFrames; ++f)
    CHECK(glm::distance(place_of(left, PlantPoint::Tip, test.rig, after[f]),
                        place_of(left, PlantPoint::Tip, test.rig, before[f])) < 0.05);
}

TEST_CASE("cleaning clips: a hand that rested and does not reach its place any more is named") {
  // An almost straight arm holds on to something ahead while the body sways. Holding a foot far aside then moves the
  // body, so the hand cannot stay.
  const Armature rig = walker();
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  REQUIRE(limbs[0].name == "left foot");
  REQUIRE(limbs[2].name == "left hand");
  std::vector<Pose> poses(kFrames, rest_pose(rig));
  for (int f = 0; f < kFrames; ++f) poses[f].root_translation = {15 * std::sin(f * 0.1), 0, 0};
  const glm::dvec3 shoulder = rig.bones[limbs[2].upper].head;
  poses = planted(rig, limbs, poses, {{2, PlantPoint::Tip, 0, kFrames - 1, shoulder + glm::dvec3(0, -500, -290)}}, 6);
  WalkerEditor test(poses);
  test.play(
      "click \"Motion/Clip/Hold a hand or foot...\"\n wait-idle\n click Limb/list\n click \"Limb/left foot\"\n click "
      "\"Result/New clip\"\n click \"Hold at/Position\"\n wait-idle\n click \"Position/text\"\n key Ctrl+A\n type "
      "\"400, -150, 10\"\n wait-idle\n click Hold\n wait-job\n wait-idle");
  REQUIRE(test.editor->document().clips.size() == 2);
  REQUIRE(!test.editor->messages->toasts.empty());
  const Toast& toast = test.editor->messages->toasts.back();
  CAPTURE(toast.detail);
  CHECK(toast.severity == Severity::Warning);
  CHECK(toast.detail.find("the left hand does not reach its position") != std::string::npos);
}

TEST_CASE("reducing clips: where feet cannot be kept as closely as asked, a warning says so") {
  WalkerEditor test;
  test.play("click \"Motion/Clip/Clean clip...\"\n wait-idle\n key Return\n wait-job\n wait-idle");
  const auto reduced_with = [&](const char* mm) {
    test.play(std::string("click \"Motion/Clip/Reduce to keys...\"\n wait-idle\n double-click \"Planted "
                          "feet/value\"\n key Ctrl+A\n type ") +
              mm + "\n key Tab\n wait-idle\n click Reduce\n wait-job\n wait-idle");
    REQUIRE(!test.editor->messages->toasts.empty());
    return test.editor->messages->toasts.back();
  };
  CHECK(reduced_with("1").severity != Severity::Warning);
  test.play("key Ctrl+Z\n wait-idle");
  const Toast closer = reduced_with("0.00000001");
  CAPTURE(closer.detail);
  CHECK(closer.severity == Severity::Warning);
  CHECK(closer.detail.find("more than the 1e-08 mm") != std::string::npos);
}

TEST_CASE("cleaning clips: what cannot be done is said, and nothing changes") {
  WalkerEditor test;
  const Document old = test.editor->document();
  // Without a filter and with the feet as they are, there is nothing to do.
  test.play(
      "click \"Motion/Clip/Clean clip...\"\n wait-idle\n click \"Feet/As they are\"\n double-click "
      "\"Smooth/value\"\n key Ctrl+A\n type 0\n key Tab\n wait-idle\n click Clean\n wait-idle");
  CHECK(test.editor->dialogs->shown);
  test.play("key Escape\n wait-idle");
  CHECK(test.editor->document().clips == old.clips);

  // The field of the position starts empty: the user must type one.
  test.play(
      "click \"Motion/Clip/Hold a hand or foot...\"\n wait-idle\n click \"Hold at/Position\"\n click Limb/list\n click "
      "\"Limb/left foot\"\n wait-idle\n click Hold\n wait-job\n wait-idle");
  CHECK(test.editor->dialogs->shown);
  test.play("key Escape\n wait-idle");
  CHECK(test.editor->document().clips == old.clips);

  // Tries positions that are too large or not finite.
  for (const char* far : {"1e200, 0, 0", "0, 2000000, 0", "0, 0, nan"}) {
    CAPTURE(far);
    test.play(
        "click \"Motion/Clip/Hold a hand or foot...\"\n wait-idle\n click \"Hold at/Position\"\n wait-idle\n click "
        "\"Position/text\"\n key Ctrl+A\n type \"" +
        std::string(far) + "\"\n wait-idle\n click Hold\n wait-job\n wait-idle");
    CHECK(test.editor->dialogs->shown);
    test.play("key Escape\n wait-idle");
    CHECK(test.editor->document().clips == old.clips);
  }

  // A rig without known limbs has no limb to hold.
  Document nameless = old;
  Armature rig = *old.armature;
  for (Bone& bone : rig.bones) bone.name = "b" + std::to_string(&bone - rig.bones.data());
  nameless.armature = std::make_shared<const Armature>(rig);
  test.editor->history->reset(std::move(nameless), "Open");
  CHECK(find_operator(test.editor->operators, "motion.hold")->disabled_reason(*test.editor).find("known names") !=
        std::string::npos);
}
