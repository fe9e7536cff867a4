// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/motion/motion_path_overlay.h"
#include "editor/motion/onion_skin_overlay.h"
#include "editor/motion/timeline.h"
#include "editor/motion/timeline_tool.h"
#include "editor/pose/pose_edits.h"
#include "editor/shown/frame_all.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_clip.h"

namespace limber::test {

using namespace editor;

namespace {

struct BendingEditor : SmallEditor {
  explicit BendingEditor(const Document& document = bending_limb(), const glm::ivec2& size = {1280, 720})
      : SmallEditor(size, {}, false) {
    editor->history->reset(document, "Open limb");
    editor->project->name = "limb";
    frame_all(*editor, false);
    play("key Ctrl+3");
    player.settle();
  }
  double shown_bend() { return bend_of(shown_pose(*editor)); }
  double bend() { return bend_of(pose_of(editor->document())); }
  glm::vec2 on_ruler(int frame) {
    return {std::round(x_of(*editor->timeline, frame)), editor->timeline->ruler.centre().y};
  }
  void move_to(const glm::vec2& place) {
    play("move " + std::to_string(static_cast<int>(place.x)) + " " + std::to_string(static_cast<int>(place.y)));
  }
  void press(int frame) {
    move_to(on_ruler(frame));
    host->events.push(ButtonChanged{MouseButton::Left, true});
    player.step();
  }
  void release() {
    host->events.push(ButtonChanged{MouseButton::Left, false});
    player.settle();
  }
};

}  // namespace

TEST_CASE(
    "timeline: a press on the ruler shows that frame's pose in the same picture, and the release takes it as one "
    "edit") {
  BendingEditor test;
  const auto steps = test.editor->history->position();
  test.press(20);
  CHECK(shown_frame(*test.editor) == 20);
  CHECK(test.shown_bend() == doctest::Approx(20));
  CHECK(test.editor->history->position() == steps);
  for (int frame : {25, 31, 40}) {
    test.host->events.push(PointerMoved{test.on_ruler(frame)});
    test.player.step();
    CHECK(shown_frame(*test.editor) == frame);
    CHECK(test.shown_bend() == doctest::Approx(frame));
  }
  test.release();
  CHECK(test.editor->document().frame == 40);
  CHECK(test.bend() == doctest::Approx(40));
  CHECK(test.editor->history->position() == steps + 1);
}

TEST_CASE("timeline: Escape during scrubbing goes back to the frame before") {
  BendingEditor test;
  test.press(20);
  test.play("key Escape");
  test.release();
  CHECK(shown_frame(*test.editor) == 0);
  CHECK(test.shown_bend() == doctest::Approx(0));
}

TEST_CASE("timeline: steps from frame to frame are one edit, which undo takes back with the pose that was there") {
  BendingEditor test;
  Pose changed = pose_of(test.editor->document());
  changed.rotation[0] = glm::angleAxis(0.5, glm::dvec3(0, 0, 1));
  commit_pose(*test.editor, "Turn", changed);
  const auto steps = test.editor->history->position();
  test.play("key Right\n key Right\n key Right");
  CHECK(test.editor->document().frame == 3);
  CHECK(test.bend() == doctest::Approx(3));
  CHECK(pose_of(test.editor->document()).rotation[0] == glm::dquat(1, 0, 0, 0));
  CHECK(test.editor->history->position() == steps + 1);
  test.play("key Ctrl+Z");
  CHECK(test.editor->document().frame == 0);
  CHECK(pose_of(test.editor->document()) == changed);
}

TEST_CASE("timeline: a playing clip shows the frame of the moment, whatever the pictures cost") {
  BendingEditor test(bending_limb(601, 120));
  test.play("key Space");
  const double began = test.editor->timeline->play.since;
  for (const double later : {0.1, 0.35, 0.36, 2.0, 4.9}) {
    test.editor->frame(began + later);
    CHECK(shown_frame(*test.editor) == static_cast<int>(std::floor(later * 120 + 1e-3)));
    CHECK(test.shown_bend() == doctest::Approx(std::remainder(shown_frame(*test.editor), 720)).epsilon(1e-5));
  }
  test.editor->frame(began + 601 / 120.0 + 0.25);
  CHECK(shown_frame(*test.editor) == 30);  // at the start of the range
}

TEST_CASE("timeline: playing stops at the range's end, begins again there, or turns round") {
  for (const auto& [mode, expected] : {std::pair{AtEnd::Stop, 30}, {AtEnd::Loop, 14}, {AtEnd::PingPong, 25}}) {
    CAPTURE(static_cast<int>(mode));
    BendingEditor test;
    edit_clip(*test.editor, "Set range", PoseThen::Stays, [](Clip& clip) {
      clip.range_start = 10;
      clip.range_end = 30;
    });
    test.editor->timeline->play.at_end = mode;
    go_to_frame(*test.editor, 10);
    play(*test.editor, 1);
    test.editor->frame(test.editor->ui->now + 25.01 / 30);
    CHECK(shown_frame(*test.editor) == expected);
    CHECK(test.editor->timeline->play.on == (mode != AtEnd::Stop));
  }
}

TEST_CASE("timeline: what changes the pose stops the playing at the frame that is seen") {
  BendingEditor test;
  test.play("key Space\n wait 0.5");
  CHECK(test.editor->timeline->play.on);
  run(*test.editor, "motion.insert_key");
  test.play("key Space");
  CHECK_FALSE(test.editor->timeline->play.on);
  CHECK(test.editor->document().frame > 10);
  CHECK(test.bend() == doctest::Approx(test.editor->document().frame));
}

TEST_CASE("timeline: an unkeyed change lasts until the frame changes, a keyed one stays with its frame") {
  BendingEditor test;
  go_to_frame(*test.editor, 10);
  Pose changed = pose_of(test.editor->document());
  changed.rotation[1] = glm::angleAxis(glm::radians(40.0), glm::dvec3(1, 0, 0));
  commit_pose(*test.editor, "Bend", changed);
  go_to_frame(*test.editor, 11);
  go_to_frame(*test.editor, 10);
  CHECK(test.bend() == doctest::Approx(10));

  test.editor->timeline->auto_key = true;
  commit_pose(*test.editor, "Bend", changed);
  go_to_frame(*test.editor, 11);
  CHECK(test.bend() == doctest::Approx(41));  // 30 degrees more than the motion has
  go_to_frame(*test.editor, 10);
  CHECK(pose_of(test.editor->document()) == changed);
}

TEST_CASE("timeline: keys without a motion make a clip of their own") {
  BendingEditor test(small_limb());
  CHECK(test.fact("text:No clip") == "shown");
  Pose bent = pose_of(test.editor->document());
  run(*test.editor, "motion.insert_key");
  go_to_frame(*test.editor, 10);
  bent.rotation[1] = glm::angleAxis(glm::radians(60.0), glm::dvec3(1, 0, 0));
  commit_pose(*test.editor, "Bend", bent);
  run(*test.editor, "motion.insert_key");
  go_to_frame(*test.editor, 5);
  CHECK(test.bend() == doctest::Approx(30));
  go_to_frame(*test.editor, 99);
  CHECK(test.bend() == doctest::Approx(60));
}

TEST_CASE("timeline: a frame that is typed stays in the clip, and a range does not cross itself, both are told") {
  BendingEditor test;
  const auto type = [&](const char* field, const char* number) {
    test.play(std::string("double-click timeline/\"") + field + "\"\nkey Ctrl+A\ntype \"" + number +
              "\"\nkey Return\nwait-idle");
  };
  type("Frame", "99999");
  CHECK(test.editor->document().frame == 60);
  CHECK(test.fact("text:outside the clip") == "shown");
  type("Frame", "-50");
  CHECK(test.editor->document().frame == 0);
  type("Range start", "500");
  CHECK(playing_range(test.editor->document()).low == 60);
  CHECK(playing_range(test.editor->document()).high == 60);
  CHECK(test.fact("text:The range begins at frame 60") == "shown");
  type("Range start", "20");
  type("Range end", "-7");
  CHECK(playing_range(test.editor->document()).high == 20);
  type("Range end", "900");
  CHECK(x_of(*test.editor->timeline, 900) <= test.editor->timeline->ruler.high.x);
}

TEST_CASE(
    "timeline: the play head stays with its moment when frames go or get another rate, and is never out of sight") {
  BendingEditor test;
  const auto head = [&] { return x_of(*test.editor->timeline, shown_frame(*test.editor)); };
  const auto seen = [&] {
    return head() >= test.editor->timeline->ruler.low.x && head() <= test.editor->timeline->ruler.high.x;
  };
  edit_clip(*test.editor, "Set range", PoseThen::Stays, [](Clip& clip) { clip.range_start = 20, clip.range_end = 40; });
  go_to_frame(*test.editor, 5);
  run(*test.editor, "motion.trim");
  test.player.settle();
  CHECK(test.editor->document().frame == 20);
  CHECK(test.bend() == doctest::Approx(20));
  CHECK(test.fact("text:The play head is at frame 20") == "shown");
  CHECK(seen());

  go_to_frame(*test.editor, 30);
  test.play(
      "click \"Motion/Clip/Resample clip...\"\ndouble-click \"Frame rate/value\"\nkey Ctrl+A\ntype 60\nkey "
      "Return\nwait-idle");
  CHECK(test.editor->document().frame == 40);
  CHECK(test.bend() == doctest::Approx(30).epsilon(0.01));

  auto& window = test.editor->timeline->window;
  for (const int frame : {-2000, 2000, 33}) {  // the window must show any frame
    window.low = 20, window.count = 10;
    go_to_frame(*test.editor, frame);
    test.player.settle();
    CHECK(seen());
    CHECK(window.count == 10);
  }
  // The user scrolls away: the frame marker stays visible at the edge.
  window.low = 500;
  test.player.settle();
  CHECK(window.low == 500);
  CHECK(test.fact("text:33") == "shown");
}

TEST_CASE("timeline: the ruler's zero has no sign, and the tab counts what the ruler counts") {
  BendingEditor test;
  go_to_frame(*test.editor, 30);
  for (const bool seconds : {false, true})
    for (double low = -12.3; low < 0; low += 1.7) {
      test.editor->timeline->seconds = seconds;
      test.editor->timeline->window.low = low;
      test.player.settle();
      for (const std::string& text : test.editor->ui->widgets.texts()) CHECK_FALSE((text == "-0" || text == "-0.00"));
      CHECK(test.fact("text:1.00 s") == "shown");
      CHECK(test.fact("text:frame 30") == (seconds ? "shown" : "absent"));
    }
}

TEST_CASE(
    "timeline: the curve has a point at each frame that is wide enough, and markers have a row in small windows too") {
  {
    BendingEditor test;
    test.editor->selection->bone = 1;
    test.editor->ui->touch();
    test.player.settle();
    const auto& curve = test.editor->timeline->curve;
    CHECK(curve.step == 1);
    REQUIRE(curve.angles.size() > 60);
    for (int i = 0; i < std::ssize(curve.angles); ++i)
      CHECK(curve.angles[i].x == doctest::Approx(std::clamp(curve.first + i, 0, 60)).epsilon(1e-3));
    CHECK(test.fact("widget:timeline/motion.loop") == "shown");
    CHECK(test.fact("widget:timeline/motion.ping_pong") == "shown");
  }
  BendingEditor small(bending_limb(), {1024, 640});
  CHECK(small.fact("widget:timeline/marks") == "shown");
}

TEST_CASE("timeline: buttons and rows stand inside the area and beside one another at every size") {
  for (const auto& [size, scale] :
       {std::pair<glm::ivec2, double>{{1280, 720}, 1}, {{1600, 900}, 1}, {{2560, 1440}, 2}, {{1024, 640}, 1}}) {
    CAPTURE(size.x);
    Preferences preferences;
    preferences.scale = scale;
    SmallEditor test(size, preferences, false);
    test.editor->history->reset(bending_limb(), "Open limb");
    test.play("key Ctrl+3");
    test.player.settle();
    const auto& widgets = test.editor->ui->widgets.widgets();
    for (const Widget& widget : widgets) {
      if (widget.region != Region::Bottom) continue;
      CHECK(test.editor->screen->layout.bottom.contains(widget.rect));
      for (const Widget& other : widgets)
        if (other.region == Region::Bottom && other.name != widget.name) CHECK_FALSE(widget.rect.overlaps(other.rect));
    }
  }
}

TEST_CASE("timeline: another clip chosen from the list is shown at a frame it has, as one edit") {
  Document document = bending_limb();
  add_clip(document, clip_of(std::make_shared<const Motion>(bending_motion(*document.armature, 21)), "short"));
  BendingEditor test(document);
  go_to_frame(*test.editor, 15);
  test.play("click Motion/Clip/list\n click Clip/bending\n wait-idle");
  CHECK(shown_clip(test.editor->document())->name == "bending");
  CHECK(test.fact("edit") == "Show clip bending");
  CHECK(test.bend() == doctest::Approx(15));
  go_to_frame(*test.editor, 50);
  test.play("click Motion/Clip/list\n click Clip/short\n wait-idle");
  CHECK(shown_clip(test.editor->document())->name == "short");
  CHECK(test.editor->document().frame == 20);
  CHECK(test.bend() == doctest::Approx(20));
  test.play("key Ctrl+Z");
  CHECK(shown_clip(test.editor->document())->name == "bending");
  CHECK(test.bend() == doctest::Approx(50));
}

TEST_CASE("onion skin: the body's outline is drawn at the frames before and after, kept while the view stands still") {
  Document document = bending_limb();
  // The whole body follows the lower bone.
  document.weights =
      std::make_shared<const SkinWeights>(std::vector<std::string>{"Fore", "Upper"}, TissueVoxels(*document.volume));
  BendingEditor test(document);
  auto& onion = test.editor->timeline->onion;
  go_to_frame(*test.editor, 40);
  onion.count = 1;
  onion.step = 20;
  test.play("move \"3D view/view\"\n key Shift+O\n wait-job\n wait-idle");
  REQUIRE(onion.outlines);
  REQUIRE(onion.outlines->lines.size() == 2);
  const auto middle_of = [&](int frame) {
    glm::vec2 low(1e9f), high(-1e9f);
    for (const auto& line : onion.outlines->lines.at(frame))
      for (const glm::vec2& p : line) low = glm::min(low, p), high = glm::max(high, p);
    return (low + high) / 2.0f;
  };
  // The ball is centred at the joint, so its outline does not move when it turns.
  const auto joint = body_seen(*test.editor)->pixel_of(glm::dvec3(0));
  for (const int frame : {20, 60})
    CHECK(glm::distance(middle_of(frame), glm::vec2(*joint)) < 0.1f * test.editor->screen->layout.window.size().y);
  const auto* kept = onion.outlines->lines.at(20).data();
  test.play("key Left\n key Right\n wait-idle");
  CHECK(onion.outlines->lines.at(20).data() == kept);
  CHECK(onion.outlines->lines.size() > 2);
  test.play("key Num3\n wait-idle");
  CHECK(onion.outlines->lines.size() == 2);
  test.play("key Shift+O\n wait-idle");
}

TEST_CASE("motion paths: the tip of a bending bone runs along an arc, drawn over the view, and follows the clip") {
  LimbEditor test;
  test.editor->history->reset(bending_limb(), "Open limb");
  test.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
  CHECK(motion_paths(*test.editor) == nullptr);
  test.editor->timeline->paths.on = true;
  CHECK(motion_paths(*test.editor) == nullptr);  // no paths without a selected bone
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  test.play("wait-idle");
  const MotionPaths* paths = motion_paths(*test.editor);
  REQUIRE(paths);
  REQUIRE(paths->tips.size() == 61);
  for (int frame = 0; frame < 61; ++frame) {
    // The bone hangs 36 mm along -z from the joint at the origin, and turns about x by one degree per frame.
    const double angle = glm::radians(double(frame));
    CHECK(glm::distance(paths->tips[frame][0], glm::dvec3(0, 36 * std::sin(angle), -36 * std::cos(angle))) < 1e-3);
  }
  // Adding a key changes the path.
  go_to_frame(*test.editor, 60);
  edit_clip(*test.editor, "Key", PoseThen::FromClip,
            [](Clip& clip) { clip.keys.bones["Fore"][60] = glm::dquat(1, 0, 0, 0); });
  test.play("wait-idle");
  paths = motion_paths(*test.editor);
  REQUIRE(paths);
  CHECK(glm::distance(paths->tips[60][0], glm::dvec3(0, 0, -36)) < 1e-3);
}

}  // namespace limber::test
