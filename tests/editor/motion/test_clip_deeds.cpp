// SPDX-License-Identifier: AGPL-3.0-or-later
// Mirrors, repeats, joins, speeds up and bakes whole clips in the editor. The played clip equals the computed one, undo
// restores the old clip, and errors are reported.
#include <doctest/doctest.h>

#include "core/motion/clip_speed.h"
#include "core/motion/ground_move.h"
#include "core/motion/join_poses.h"
#include "core/motion/key_curve.h"
#include "core/motion/loop_poses.h"
#include "core/motion/motion_edit.h"
#include "core/rig/mirror.h"
#include "editor/context/dialogs.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "tests/editor/small_editor.h"
#include "tests/support/program.h"
#include "tests/support/sliding_walker.h"

using namespace limber;
using namespace limber::test;
using namespace limber::editor;

namespace {

constexpr int kFrames = 85, kStart = 5;  // number of frames: about two steps; first frame
constexpr double kRate = 60;

// The editor with a walker whose left arm has keys on top of its steps. The clip begins at frame 5.
struct DeedEditor : SmallEditor {
  DeedEditor() : SmallEditor({1280, 720}, {}, false) {
    Document document = small_body();
    document.armature = std::make_shared<const Armature>(rig);
    const std::vector<Pose> poses = sliding_steps(rig, kFrames, 0.01);
    Clip clip = clip_for(
        document,
        std::make_shared<const Motion>(motion_of_poses(rig, kFrames, kRate, [&](int frame) { return poses[frame]; })),
        "steps", kStart);
    clip.keys.bones["LeftArm"] = {{20, glm::angleAxis(0.7, glm::dvec3(1, 0, 0))},
                                  {40, glm::angleAxis(0.4, glm::dvec3(0, 1, 0))}};
    clip.markers = {{30, "here"}};
    add_clip(document, std::move(clip));
    editor->history->reset(std::move(document), "Open walker");
    editor->project->name = "walker";
    frame_all(*editor, false);
    play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
  }

  // Returns the poses of the shown clip in its playing range.
  std::vector<Pose> played() {
    std::vector<Pose> all;
    const ClipOnRig* clip = clip_on_rig(*editor);
    REQUIRE(clip);
    CHECK(clip->problem() == "");
    const auto [low, high] = playing_range(editor->document());
    for (int frame = low; frame <= high; ++frame) all.push_back(clip->at(frame));
    return all;
  }
  void deed(const std::string& name, const std::string& more) {
    play("click \"Motion/Clip/Whole clip/" + name + "\"\n wait-idle\n " + more + "\n wait-job\n wait-idle");
  }
  // Undoes the last edit, checks that the document is the old one, and redoes the edit.
  void undo_and_redo(const Document& old) {
    const Document now = editor->document();
    play("key Ctrl+Z\n wait-idle");
    CHECK(editor->document().clips == old.clips);
    CHECK(*editor->document().pose == *old.pose);
    play("key Shift+Ctrl+Z\n wait-idle");
    CHECK(editor->document().clips == now.clips);
    CHECK(*editor->document().pose == *now.pose);
  }

  const Armature rig = walker();
};

// Returns the largest difference between two lists of poses, in radians of a bone or metres of the body.
double farthest(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t f = 0; f < a.size(); ++f) {
    most = std::max(most, glm::distance(a[f].root_translation, b[f].root_translation) / 1000);
    for (std::size_t bone = 0; bone < a[f].rotation.size(); ++bone)
      most = std::max(most, glm::length(turn_between(a[f].rotation[bone], b[f].rotation[bone])));
  }
  return most;
}

}  // namespace

TEST_CASE("whole clips: mirrored, every frame is the mirror image, and again it is what it was") {
  DeedEditor test;
  const Document old = test.editor->document();
  std::vector<Pose> wanted = test.played();
  const std::vector<Pose> before = wanted;
  for (Pose& pose : wanted) pose = flipped(pose, test.rig);
  test.deed("Mirror clip", "");
  CHECK(farthest(test.played(), wanted) < 1e-9);
  CHECK(shown_clip(test.editor->document())->keys.bones.contains("RightArm"));
  test.undo_and_redo(old);
  test.deed("Mirror clip", "");
  CHECK(farthest(test.played(), before) < 1e-9);
}

TEST_CASE("whole clips: baked, what plays is the same without keys") {
  DeedEditor test;
  const Document old = test.editor->document();
  const std::vector<Pose> before = test.played();
  test.deed("Bake clip", "");
  CHECK(shown_clip(test.editor->document())->keys.empty());
  CHECK(shown_clip(test.editor->document())->markers == old.clips[0]->markers);
  CHECK(test.editor->document().clips.size() == 1);
  CHECK(farthest(test.played(), before) < 1e-6);
  test.undo_and_redo(old);
}

TEST_CASE("whole clips: repeated, the new clip plays what was computed") {
  DeedEditor test;
  const Document old = test.editor->document();
  const std::vector<Pose> before = test.played();
  test.deed("Loop clip...", "click \"Body/In place\"\n wait-idle\n key Return");
  const LoopedPoses spot = looped(test.rig, before, {.repeats = 4, .blend = 18, .stays = true});
  CHECK(test.fact("clip") == "steps loop");
  CHECK(farthest(test.played(), spot.poses) < 2e-6);
  test.undo_and_redo(old);
  test.play("key Ctrl+Z\n wait-idle");
  test.deed(
      "Loop clip...",
      "double-click Repeats/value\n key Ctrl+A\n type 3\n key Tab\n click \"Result/Same clip\"\n wait-idle\n click "
      "Loop");
  CHECK(test.editor->document().clips.size() == 1);
  CHECK(farthest(test.played(), looped(test.rig, before, {.repeats = 3, .blend = 18}).poses) < 2e-6);
  CHECK(playing_range(test.editor->document()).high == kStart + 3 * (kFrames - 1));
}

TEST_CASE("whole clips: a take from a file is joined at the place, heading and rate of the shown one") {
  DeedEditor test;
  const TemporaryFolder folder;
  // The second recording has half the rate, and is moved and turned aside.
  std::vector<Pose> other = sliding_steps(test.rig, 60);
  for (Pose& pose : other) pose = moved(test.rig, pose, {2.2, {0, 0, 0}, {4000, 1000, 0}});
  write_bvh(motion_of_poses(test.rig, 60, kRate / 2, [&](int frame) { return other[frame]; }), folder / "other.bvh");
  const Document old = test.editor->document();
  const std::vector<Pose> before = test.played();
  test.deed("Join clip...",
            "type \"" + (folder / "other.bvh").string() +
                "\"\n key Return\n wait-job\n wait-idle\n click \"Feet/As they are\"\n wait-idle\n click "
                "Join");
  CHECK(test.fact("clip") == "steps + other");
  const JoinedPoses wanted = joined(test.rig, {}, before, at_speed(other, 0.5), kRate, {.fade = 18});
  CHECK(farthest(test.played(), wanted.poses) < 2e-6);
  const std::vector<Marker>& markers = shown_clip(test.editor->document())->markers;
  REQUIRE(markers.size() == 2);
  CHECK(markers[1].name == "other");
  CHECK(markers[1].frame == kStart + kFrames - 18);
  test.undo_and_redo(old);
}

TEST_CASE("whole clips: a length is set, and what cannot be reached is said") {
  DeedEditor test;
  const Document old = test.editor->document();
  const std::vector<Pose> before = test.played();
  const auto set_length = [](const std::string& frames) {
    return "click \"Change by/Length\"\n double-click Length/value\n key Ctrl+A\n type " + frames +
           "\n key Tab\n wait-idle\n";
  };
  test.deed("Change speed...", set_length("3") + "click Change\n wait-idle");
  // A speed factor of 28 is refused, so the dialog stays open.
  CHECK(test.editor->dialogs->shown);
  test.play("key Escape\n wait-idle");
  CHECK(test.editor->document().clips == old.clips);
  test.deed("Change speed...", set_length("43") + "click Change\n wait-idle");
  CHECK_FALSE(test.editor->dialogs->shown);
  const std::vector<Pose> after = test.played();
  REQUIRE(after.size() == 43);
  // The key at frame 20 would move to frame 12.5, so the arm is not compared.
  for (std::size_t f = 0; f < after.size(); ++f)
    CHECK(glm::length(turn_between(after[f].rotation[1], before[2 * f].rotation[1])) < 1e-6);
  test.undo_and_redo(old);
}

TEST_CASE("whole clips: the play head stays at its place in the motion when the speed changes") {
  DeedEditor test;
  go_to_frame(*test.editor, kStart + 40);
  test.play("wait-idle");
  const glm::dquat spine = test.editor->document().pose->rotation[1];
  test.deed("Change speed...", "double-click Speed/value\n key Ctrl+A\n type 2\n key Tab\n wait-idle\n click Change");
  CHECK(test.editor->document().frame == kStart + 20);
  CHECK(why_not_redo(*test.editor) == "");  // the speed can be adjusted afterwards
  CHECK(glm::length(turn_between(test.editor->document().pose->rotation[1], spine)) < 1e-6);
}

TEST_CASE("whole clips: what was computed for another rig is refused") {
  DeedEditor test;
  const std::shared_ptr<const Clip> source = test.editor->document().clips[0];
  const auto other = std::make_shared<const Armature>(test.rig);
  CHECK_THROWS_WITH_AS(take_in_clip(*test.editor, source, other, "Bake clip", *source, false),
                       doctest::Contains("rig was changed"), Error);
  CHECK(test.editor->document().clips[0] == source);
}

TEST_CASE("whole clips: a cancelled bake or change of speed leaves the document as it was") {
  DeedEditor test;
  test.editor->preferences->reduce_motion = true;
  // Uses so many frames that computing takes longer than cancelling.
  Document document = test.editor->document();
  const std::vector<Pose> poses = sliding_steps(test.rig, kFrames, 0.01);
  const auto long_take = std::make_shared<const Motion>(
      motion_of_poses(test.rig, 100'000, kRate, [&](int frame) { return poses[frame % kFrames]; }));
  document.clips = {std::make_shared<const Clip>(clip_for(document, long_take, "long", 0))};
  document.clip = 0;
  test.editor->history->reset(document, "Open walker");
  test.play("wait-idle");
  const std::string speed =
      "click \"Motion/Clip/Whole clip/Change speed...\"\n wait-idle\n double-click Speed/value\n key Ctrl+A\n type "
      "0.5\n key Tab\n wait-idle\n click Change";
  for (const std::string& deed : {std::string("click \"Motion/Clip/Whole clip/Bake clip\""), speed}) {
    INFO(deed);
    const Document before = test.editor->document();
    test.play(deed);
    REQUIRE(test.editor->jobs->busy());
    test.editor->jobs->cancel_all();
    test.play("wait-job\n wait-idle");
    CHECK_FALSE(test.editor->jobs->busy());
    CHECK(test.editor->document() == before);
    CHECK(test.fact("error") == "none");
  }
}
