// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests each operator of the strips' view, and tests what dragging strips and their ends does to a clip.
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/motion/strip_view.h"

#include <cmath>

#include "core/motion/strips_on_rig.h"
#include "editor/context/document_edits.h"
#include "editor/motion/timeline_faces.h"
#include "editor/motion/timeline_tool.h"
#include "editor/shown/shown_pose.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/small_clip.h"

namespace limber::test {

using namespace editor;

namespace {

// Makes the limb with three clips. The first bends the limb from frame 0 to 60, the second has keys only, and the third
// plays the other two as strips: the first on the lower track from frame 0 to 60, the second on the upper track from 20
// to 50.
Document limb_with_strips() {
  Document document = bending_limb();
  Clip keys{.name = "keys", .range_end = 30};
  keys.keys.bones["Upper"] = {{0, glm::angleAxis(0.5, glm::dvec3(0, 1, 0))}};
  document.clips.push_back(std::make_shared<const Clip>(keys));
  Strips strips;
  strips.tracks.push_back({.name = "Low", .strips = {strip_of(document.clips[0], strips, 0)}});
  strips.tracks.push_back({.name = "High", .strips = {strip_of(document.clips[1], strips, 20)}});
  strips.tracks[1].strips[0].holds = false;
  Clip clip{.name = "strips", .range_end = 60};
  clip.strips = std::make_shared<const Strips>(strips);
  document.clips.push_back(std::make_shared<const Clip>(clip));
  document.clip = 2;
  document.frame = 0;
  document.pose = pose_at_frame(document);
  return document;
}

void open_strips(Context& editor, const std::function<void(const std::string&)>& play, Document document) {
  editor.timeline->play = {};
  editor.history->reset(std::move(document), "Open limb");
  editor.timeline->graph.reset();
  editor.timeline->strips.reset();
  editor.timeline->frame.reset();
  editor.timeline->shows_graph = false;
  editor.timeline->shows_strips = true;
  editor.timeline->window.clip.clear();
  *editor.selection = {};
  play("key Ctrl+3\n wait-idle\n move \"timeline/ruler\"\n wait-idle");
  if (shown_strips(editor)) play("move timeline/strips\n wait-idle");
}

std::function<void(Stage&)> in_strips(const std::set<std::string>& chosen = {}, int frame = 0) {
  return [=](Stage& s) {
    open_strips(
        s.editor(), [&](const std::string& script) { s.play(script); }, limb_with_strips());
    StripView& view = strip_view(s.editor().timeline);
    view.chosen = chosen;
    if (!chosen.empty()) view.active = *chosen.begin();
    if (frame != 0) go_to_frame(s.editor(), frame);
    s.play("wait-idle");
  };
}

const Strips& strips_in(Context& editor) { return *shown_clip(editor.document())->strips; }
const Strip& strip_named(Context& editor, const std::string& name) {
  const StripPlace place = *find_strip(strips_in(editor), name);
  return strips_in(editor).tracks[place.track].strips[place.index];
}
bool has_strip(Context& editor, const std::string& name) { return find_strip(strips_in(editor), name).has_value(); }

struct StripEditor : SmallEditor {
  explicit StripEditor(Document document = limb_with_strips()) : SmallEditor({1280, 760}, {}, false) {
    open_strips(
        *editor, [this](const std::string& script) { play(script); }, std::move(document));
    player.settle();
  }
  glm::vec2 point(const std::string& name, double share) {
    const Rect place = strip_rect(*editor, *find_strip(*shown_strips(*editor), name));
    return {place.low.x + share * place.width(), place.centre().y};
  }
  float x(int frame) { return x_of(*editor->timeline, frame); }
  void press(const glm::vec2& from, const glm::vec2& to) {
    for (int step = 0; step <= 4; ++step) {
      host->events.push(PointerMoved{glm::mix(from, to, step / 4.0f)});
      player.step();
      if (step == 0) host->events.push(ButtonChanged{MouseButton::Left, true});
      player.step();
    }
  }
  void release() {
    host->events.push(ButtonChanged{MouseButton::Left, false});
    player.settle();
  }
  void drag(const glm::vec2& from, const glm::vec2& to) {
    press(from, to);
    release();
  }
  void hold(Key key, bool down) {
    host->events.push(KeyChanged{key, down});
    player.step();
  }
  void undo() { play("key Ctrl+Z\n wait-idle"); }
  void redo() { play("key Ctrl+Shift+Z\n wait-idle"); }
};

}  // namespace

std::vector<Proof> proofs_of_strips() {
  const auto strip_is = [](const std::string& name, const std::function<bool(const Strip&)>& is) {
    return [=](Stage& s, const Seen&) { return has_strip(s.editor(), name) && is(strip_named(s.editor(), name)); };
  };
  const auto track_is = [](std::size_t track, const std::function<bool(const StripTrack&)>& is) {
    return [=](Stage& s, const Seen&) {
      return strips_in(s.editor()).tracks.size() > track && is(strips_in(s.editor()).tracks[track]);
    };
  };
  const auto menu = [](const char* id) { return std::string("click \"Motion/Strips/") + id + "\"\n wait-idle"; };
  const auto on_track = [](const std::string& track) {
    return [=](Stage& s) {
      in_strips()(s);
      strip_view(s.editor().timeline).track = track;
      s.play("wait-idle");
    };
  };
  const auto on_clip = [](Stage& s) {
    in_strips()(s);
    run(s.editor(), "motion.show_rows");
    Document document = limb_with_strips();
    document.clips.resize(2);
    document.clip = 0;
    s.editor().history->reset(std::move(document), "Open limb");
    s.play("wait-idle");
  };
  return {
      {"motion.next_face", "key Ctrl+Tab",
       [](Stage& s, const Seen&) { return shown_face(s.editor().timeline) == TimelineFace::Rows; }, Shows::Nothing, "",
       in_strips()},
      {"motion.show_rows", "click \"Motion/Range/Timeline rows\"\n wait-idle",
       [](Stage& s, const Seen&) { return s.is("widget:timeline/keys"); }, Shows::Nothing, "", in_strips()},
      {"strips.show", menu("Strips"), [](Stage& s, const Seen&) { return s.is("widget:timeline/strips"); },
       Shows::Nothing, "",
       [](Stage& s) {
         in_strips()(s);
         run(s.editor(), "motion.show_rows");
       }},
      {"strips.make", menu("Make strips of the clip"),
       [](Stage& s, const Seen&) {
         return shown_clip(s.editor().document())->strips &&
                shown_clip(s.editor().document())->name == "bending strips" && s.is("widget:timeline/strips");
       },
       Shows::Nothing, "", on_clip},
      {"strips.add", "key Shift+A\n wait-idle\n key Return\n wait-idle",
       [](Stage& s, const Seen&) {
         return has_strip(s.editor(), "bending 2") && strip_named(s.editor(), "bending 2").start == 60;
       },
       Shows::Nothing, "", in_strips({}, 60)},
      {"strips.select", "click \"timeline/strip bending\"\n wait-idle",
       [](Stage& s, const Seen&) { return chosen_strips(s.editor()) == std::set<std::string>{"bending"}; },
       Shows::Nothing, "", in_strips()},
      {"strips.select_all", "key A", [](Stage& s, const Seen&) { return chosen_strips(s.editor()).size() == 2; },
       Shows::Nothing, "", in_strips()},
      {"strips.select_none", "key Alt+A", [](Stage& s, const Seen&) { return chosen_strips(s.editor()).empty(); },
       Shows::Nothing, "", in_strips({"keys"})},
      {"strips.pan", "drag timeline/strips 60 0 MMB",
       [](Stage& s, const Seen&) { return s.editor().timeline->window.low < -4; }, Shows::Nothing, "", in_strips()},
      {"strips.move", "key G\n key 5\n key Return",
       strip_is("keys", [](const Strip& strip) { return strip.start == 25; }), Shows::Nothing, "", in_strips({"keys"})},
      {"strips.duplicate", "key Shift+D\n key 4\n key 0\n key Return",
       strip_is("keys 2", [](const Strip& strip) { return strip.start == 60; }), Shows::Nothing, "",
       in_strips({"keys"})},
      {"strips.split", "key Y", strip_is("bending 2", [](const Strip& strip) { return strip.start == 30; }),
       Shows::Nothing, "", in_strips({"bending"}, 30)},
      {"strips.mute", "key H", strip_is("keys", [](const Strip& strip) { return strip.muted; }), Shows::Nothing, "",
       in_strips({"keys"})},
      {"strips.delete", "key X", [](Stage& s, const Seen&) { return !has_strip(s.editor(), "keys"); }, Shows::Nothing,
       "", in_strips({"keys"})},
      {"strips.bones_selected", menu("Strip/Strip on selected bones"),
       strip_is("keys", [](const Strip& strip) { return strip.bones == std::set<std::string>{"Fore"}; }),
       Shows::Nothing, "",
       [](Stage& s) {
         in_strips({"keys"})(s);
         s.editor().selection->bone = 1;
         s.editor().selection->bones = {1};
       }},
      {"strips.bones_all", menu("Strip/Strip on all bones"),
       strip_is("keys", [](const Strip& strip) { return !strip.bones; }), Shows::Nothing, "",
       [](Stage& s) {
         in_strips({"keys"})(s);
         s.editor().selection->bone = 0;
         s.editor().selection->bones = {0};
         run(s.editor(), "strips.bones_selected");
       }},
      {"strips.begin_here", menu("Strip/Begin strip where the body is"),
       strip_is("keys", [](const Strip& strip) { return strip.place != GroundMove{}; }), Shows::Nothing, "",
       in_strips({"keys"})},
      {"strips.clear_place", menu("Strip/Begin strip at clip's position"),
       strip_is("keys", [](const Strip& strip) { return strip.place == GroundMove{}; }), Shows::Nothing, "",
       [](Stage& s) {
         in_strips({"keys"})(s);
         change_active_strip(s.editor(), "Move", [](Strip& strip) { strip.place.to.x = 100; });
       }},
      {"strips.bake", menu("Bake strips to clip") + "\n wait-job",
       [](Stage& s, const Seen&) {
         return s.document().clips.size() == 4 && shown_clip(s.editor().document())->name == "strips baked" &&
                shown_clip(s.editor().document())->motion;
       },
       Shows::Nothing, "", in_strips()},
      {"strips.add_track", menu("Track/Add strip track"),
       track_is(2, [](const StripTrack& track) { return track.name == "Track 3"; }), Shows::Nothing, "", in_strips()},
      {"strips.rename_track",
       menu("Track/Rename strip track...") + "\n key Ctrl+A\n type \"Arms\"\n key Return\n wait-idle",
       track_is(1, [](const StripTrack& track) { return track.name == "Arms"; }), Shows::Nothing, "", on_track("High")},
      {"strips.track_up", menu("Track/Move strip track up"),
       track_is(1, [](const StripTrack& track) { return track.name == "Low"; }), Shows::Nothing, "", on_track("Low")},
      {"strips.track_down", menu("Track/Move strip track down"),
       track_is(0, [](const StripTrack& track) { return track.name == "High"; }), Shows::Nothing, "", on_track("High")},
      {"strips.mute_track", "click \"track High/M\"\n wait-idle",
       track_is(1, [](const StripTrack& track) { return track.muted; }), Shows::Nothing, "", in_strips()},
      {"strips.solo_track", "click \"track Low/S\"\n wait-idle",
       track_is(0, [](const StripTrack& track) { return track.solo; }), Shows::Nothing, "", in_strips()},
      {"strips.delete_track", menu("Track/Delete strip track"),
       [](Stage& s, const Seen&) { return strips_in(s.editor()).tracks.size() == 1; }, Shows::Nothing, "",
       on_track("High")},
  };
}

TEST_CASE("operators: strips are made, moved and baked") {
  Stage stage;
  prove(stage, proofs_of_strips());
}

TEST_CASE("strip view: a dragged strip moves live, one edit is made, and undo and redo have it") {
  StripEditor test;
  go_to_frame(*test.editor, 55);  // after the end of the upper strip
  const Strips before = strips_in(*test.editor);
  const auto steps = test.editor->history->position();
  const float frame = test.x(1) - test.x(0);
  const glm::vec2 from = test.point("bending", 0.2);
  test.hold(Key::Ctrl, true);
  test.press(from, from + glm::vec2(10 * frame, 0));
  // While the button is down, nothing is committed, but the body already shows the pose of the dragged strips.
  CHECK(strips_in(*test.editor) == before);
  CHECK(bend_of(shown_pose(*test.editor)) == doctest::Approx(45).epsilon(0.01));
  test.release();
  test.hold(Key::Ctrl, false);
  CHECK(test.editor->history->position() == steps + 1);
  CHECK(strip_named(*test.editor, "bending").start == 10);
  CHECK(test.fact("edit") == "Move strips");
  CHECK(bend_of(pose_of(test.editor->document())) == doctest::Approx(45).epsilon(0.01));
  test.undo();
  CHECK(strips_in(*test.editor) == before);
  CHECK(bend_of(pose_of(test.editor->document())) == doctest::Approx(55).epsilon(0.01));
  test.redo();
  CHECK(strip_named(*test.editor, "bending").start == 10);
  // Escape cancels the drag.
  test.press(test.point("bending", 0.2), test.point("bending", 0.6));
  test.hold(Key::Escape, true);
  test.hold(Key::Escape, false);
  test.release();
  CHECK(strip_named(*test.editor, "bending").start == 10);
}

TEST_CASE("strip view: a strip stops beside another, with Shift it overlaps and they cross-fade") {
  Document document = limb_with_strips();
  Strips strips = *document.clips[2]->strips;
  Strip next = strip_of(document.clips[0], strips, 100);
  insert_strip(strips.tracks[0], next);
  Clip clip = *document.clips[2];
  clip.strips = std::make_shared<const Strips>(strips);
  clip.range_end = 160;
  document.clips[2] = std::make_shared<const Clip>(clip);
  StripEditor test(std::move(document));
  const float frame = test.x(1) - test.x(0);
  test.drag(test.point("bending 2", 0.5), test.point("bending 2", 0.5) - glm::vec2(55 * frame, 0));
  CHECK(strip_named(*test.editor, "bending 2").start == 60);
  const glm::vec2 from = test.point("bending 2", 0.5);
  test.host->events.push(PointerMoved{from});
  test.player.step();
  test.host->events.push(ButtonChanged{MouseButton::Left, true});
  test.player.step();
  test.hold(Key::Shift, true);
  test.hold(Key::Ctrl, true);
  for (int step = 1; step <= 4; ++step) {
    test.host->events.push(PointerMoved{from - glm::vec2(15 * frame * static_cast<float>(step) / 4, 0)});
    test.player.step();
  }
  test.release();
  test.hold(Key::Ctrl, false);
  test.hold(Key::Shift, false);
  CHECK(strip_named(*test.editor, "bending 2").start == 45);
  CHECK(runs_of(strips_in(*test.editor).tracks[0], 30)[1].fade_in == 15);
  // The pose in the middle of the fade lies between both.
  const Pose pose = clip_on_rig(*test.editor)->at(52);
  CHECK(bend_of(pose) > 7);
  CHECK(bend_of(pose) < 52);
}

TEST_CASE("strip view: the ends of a strip are dragged to trim it, and snap to other strips") {
  StripEditor test;
  const Rect place = strip_rect(*test.editor, {0, 0});
  // Drags the strip's end to just before frame 50. It snaps to the end of the other strip, at frame 50.
  test.drag({place.high.x - 2, place.centre().y}, {test.x(50) - 1, place.centre().y});
  CHECK(strip_named(*test.editor, "bending").last == 50);
  CHECK(end_of(strip_named(*test.editor, "bending"), 30) == 50);
  CHECK(test.fact("edit") == "Trim strip");
  const Rect now = strip_rect(*test.editor, {0, 0});
  test.drag({now.low.x + 2, now.centre().y}, {test.x(20) + 3, now.centre().y});
  CHECK(strip_named(*test.editor, "bending").first == 20);
  CHECK(strip_named(*test.editor, "bending").start == 20);
  test.undo();
  test.undo();
  CHECK(strip_named(*test.editor, "bending").last == 60);
}

TEST_CASE("strip view: strips are selected by a click and a rectangle, and dragged to another track") {
  StripEditor test;
  Editor& editor = *test.editor;
  test.drag(test.point("keys", 0.5), test.point("keys", 0.5));
  CHECK(chosen_strips(editor) == std::set<std::string>{"keys"});
  CHECK(active_strip(editor)->name == "keys");
  CHECK(active_track(editor) == 1u);
  const glm::vec2 empty(test.point("keys", 1).x + 40, test.point("keys", 0.5).y);
  test.drag(empty, test.point("bending", 0.95));
  CHECK(chosen_strips(editor) == std::set<std::string>{"bending"});
  test.drag(empty, empty);
  CHECK(chosen_strips(editor).empty());
  // Drags the strip from the upper track, where it starts at frame 20, to the lower track. It stops after the end of
  // the other strip, at frame 60.
  const float row = track_rect(editor, 0).low.y - track_rect(editor, 1).low.y, frame = test.x(1) - test.x(0);
  test.drag(test.point("keys", 0.5), test.point("keys", 0.5) + glm::vec2(36 * frame, row));
  CHECK(find_strip(strips_in(editor), "keys") == StripPlace{0, 1});
  CHECK(strip_named(editor, "keys").start == 60);
}

TEST_CASE("strip view: the shown clip plays the strips, and an edit of a strip's clip is played") {
  StripEditor test;
  Editor& editor = *test.editor;
  go_to_frame(editor, 40);
  // The upper strip replaces the whole pose of the lower one.
  CHECK(bend_of(pose_of(editor.document())) == doctest::Approx(0).epsilon(0.01));
  run(editor, "strips.solo_track");
  CHECK(bend_of(pose_of(editor.document())) == doctest::Approx(40).epsilon(0.01));
  // Jobs and exports take the same pose as the editor shows.
  CHECK(*pose_at_frame(editor.document()) == pose_of(editor.document()));
  Document next = editor.document();
  Clip faster = *next.clips[0];
  faster.keys.bones["Fore"] = {{40, glm::angleAxis(1.0, glm::dvec3(1, 0, 0))}};
  next.clips[0] = std::make_shared<const Clip>(faster);
  commit(editor, "Key the bending clip", std::move(next));
  CHECK(strip_named(editor, "bending").clip == editor.document().clips[0]);
  go_to_frame(editor, 39);
  go_to_frame(editor, 40);
  CHECK(glm::degrees(1.0) == doctest::Approx(bend_of(pose_of(editor.document()))));
}

TEST_CASE("strip view: the sidebar changes the active strip, and undo takes it back") {
  StripEditor test;
  Editor& editor = *test.editor;
  choose_strip(editor, "bending");
  test.play("wait-idle");
  const auto type = [&](const std::string& field, const std::string& number) {
    test.play("click \"" + field + "\"\n wait-idle\n key Ctrl+A\n type \"" + number + "\"\n key Return\n wait-idle");
  };
  type("Strip/Strip Speed of bending", "2");
  CHECK(strip_named(editor, "bending").speed == 2);
  CHECK(end_of(strip_named(editor, "bending"), 30) == 30);
  type("Strip/Strip Influence of bending", "0.25");
  CHECK(strip_named(editor, "bending").influence == 0.25);
  test.undo();
  test.undo();
  CHECK(strip_named(editor, "bending").speed == 1);
  test.play("click \"Strip/Mirrored\"\n wait-idle");
  CHECK(strip_named(editor, "bending").mirrored);
  CHECK(test.fact("edit") == "Set strip's Mirrored");
}

TEST_CASE("strip view: Add strip changes nothing before it is confirmed, and is one edit then") {
  Document document = limb_with_strips();
  document.clips.resize(2);
  document.clip = 0;
  StripEditor test(document);
  Editor& editor = *test.editor;
  const auto position = editor.history->position();
  run(editor, "strips.add");
  test.play("wait-idle\n key Escape\n wait-idle");
  CHECK(editor.document() == document);
  CHECK(editor.history->position() == position);
  run(editor, "strips.add");
  test.play("wait-idle\n key Return\n wait-idle");
  CHECK(editor.history->position() == position + 1);
  REQUIRE(editor.document().clips.size() == 3);
  CHECK(strips_in(editor).tracks.size() == 2);
  CHECK(has_strip(editor, "bending"));
  CHECK(has_strip(editor, "bending 2"));
  test.undo();
  CHECK(editor.document() == document);
}

TEST_CASE("strip view: deleting a clip says which strips go with it, and the pose is of those that are left") {
  Document document = limb_with_strips();
  document.clip = 1;  // the keys, which the upper track plays over the bending
  StripEditor test(std::move(document));
  Editor& editor = *test.editor;
  go_to_frame(editor, 30);
  Document shown = editor.document();
  shown.clips = {shown.clips[0], shown.clips[2], shown.clips[1]};
  shown.clip = 2;
  editor.history->reset(std::move(shown), "Open limb");
  run(editor, "motion.delete_clip");
  test.play("wait-idle");
  REQUIRE(editor.dialogs->shown);
  test.play("key Escape\n wait-idle");
  CHECK(editor.document().clips.size() == 3);
  run(editor, "motion.delete_clip");
  test.play("wait-idle\n click Delete\n wait-idle");
  REQUIRE(editor.document().clips.size() == 2);
  CHECK(!has_strip(editor, "keys"));
  CHECK(editor.document().frame == 30);
  CHECK(bend_of(pose_of(editor.document())) == doctest::Approx(30).epsilon(0.01));
  // A clip that no strip plays is deleted without a question.
  run(editor, "motion.delete_clip");
  CHECK(editor.document().clips.size() == 1);
}

TEST_CASE("strip view: another frame rate or speed of a clip leaves its strips the same part of it") {
  Document document = limb_with_strips();
  document.clip = 0;
  StripEditor test(std::move(document));
  Editor& editor = *test.editor;
  const auto strips = [&]() -> const Strips& { return *editor.document().clips[2]->strips; };
  const auto bend_at = [&](int frame) {
    return bend_of(ClipOnRig(editor.document().clips[2], editor.document().armature).at(frame));
  };
  run(editor, "motion.resample");
  test.play("wait-idle\n key Ctrl+A\n type \"60\"\n key Return\n wait-idle\n key Return\n wait-idle");
  CHECK(editor.document().clips[0]->rate == 60);
  CHECK(strips().tracks[0].strips[0].last == 120);
  CHECK(strips().tracks[0].strips[0].clip == editor.document().clips[0]);
  CHECK(end_of(strips().tracks[0].strips[0], 30) == 60);
  for (const int frame : {5, 15, 55}) CHECK(bend_at(frame) == doctest::Approx(frame).epsilon(0.01));
  test.undo();
  CHECK(strips().tracks[0].strips[0].last == 60);
  run(editor, "motion.speed");
  test.play("wait-idle\n key Ctrl+A\n type \"2\"\n key Return\n wait-idle\n key Return\n wait-idle");
  CHECK(strips().tracks[0].strips[0].last == 30);
  CHECK(bend_at(10) == doctest::Approx(20).epsilon(0.01));
}

TEST_CASE("strip view: Ctrl+Tab goes through keys, curves and strips, and the button lists them") {
  StripEditor test;
  Editor& editor = *test.editor;
  test.play("move \"timeline/ruler\"\n key Ctrl+Tab\n wait-idle");
  CHECK(shown_face(editor.timeline) == TimelineFace::Rows);
  test.play("move \"timeline/ruler\"\n key Ctrl+Tab\n wait-idle");
  CHECK(shown_face(editor.timeline) == TimelineFace::Graph);
  CHECK(!editor.timeline->shows_strips);
  test.play("move \"timeline/ruler\"\n key Ctrl+Tab\n wait-idle");
  CHECK(shown_face(editor.timeline) == TimelineFace::Strips);
  CHECK(!editor.timeline->shows_graph);
  test.play("click timeline/face\n wait-idle\n click \"Timeline rows\"\n wait-idle");
  CHECK(shown_face(editor.timeline) == TimelineFace::Rows);
}

}  // namespace limber::test
