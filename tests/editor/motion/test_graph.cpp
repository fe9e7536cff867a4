// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests each operator of the graph editor, and tests what dragging keys and handles does to a clip.
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/motion/graph.h"
#include "editor/ui/ui.h"

#include <cmath>

#include "core/motion/euler_channels.h"
#include "core/motion/key_curve.h"
#include "editor/context/view_projection.h"
#include "editor/motion/graph_tool.h"
#include "editor/motion/timeline_tool.h"
#include "editor/pose/pose_edits.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/small_clip.h"

namespace limber::test {

using namespace editor;

namespace {

const GraphTrack kFore{"Fore", false};

glm::dquat turned(double x, double y, double z) { return rotation_of_channels(glm::radians(glm::dvec3(x, y, z))); }

// Opens the graph editor on keys of the lower bone at frames 10, 30 and 50, without a motion, with the pointer over the
// curves.
void open_graph(Context& editor, const std::function<void(const std::string&)>& play) {
  editor.timeline->play = {};
  Document document = bending_limb();
  Clip clip{.name = "keys", .range_end = 60};
  clip.keys.bones["Fore"] = {{10, turned(0, 0, 0)}, {30, turned(40, 10, 0)}, {50, turned(20, 0, 30)}};
  document.clips = {std::make_shared<const Clip>(clip)};
  document.frame = 0;
  document.pose = nullptr;
  editor.history->reset(std::move(document), "Open limb");
  editor.timeline->graph.reset();
  editor.timeline->shows_graph = true;
  editor.timeline->chosen.clear();
  editor.selection->bone = 1;
  editor.selection->bones = {1};
  play("key Ctrl+3\n wait-idle\n move graph\n wait-idle");
}

std::function<void(Stage&)> in_graph(const std::set<int>& chosen = {}, int axis = 0) {
  return [=](Stage& s) {
    open_graph(s.editor(), [&](const std::string& script) { s.play(script); });
    for (const int frame : chosen) graph_of(s.editor()).chosen.insert({{kFore, axis}, frame});
    s.play("wait-idle");
  };
}

const std::map<int, glm::dquat>& fore(Context& editor) { return shown_clip(editor.document())->keys.bones.at("Fore"); }
KeyShape shape(Context& editor, int frame) {
  return shape_at(shapes_of(shown_clip(editor.document())->keys, "Fore"), frame);
}
glm::dvec3 angles(Context& editor, int frame) { return glm::degrees(channel_angles(fore(editor).at(frame))); }

std::function<bool(Stage&, const Seen&)> goes_on(Interpolation interpolation) {
  return [=](Stage& s, const Seen&) {
    return shape(s.editor(), 10).next == interpolation && shape(s.editor(), 30).next != interpolation;
  };
}
std::function<bool(Stage&, const Seen&)> handles_are(HandleKind handles) {
  return [=](Stage& s, const Seen&) { return shape(s.editor(), 30).handles == handles; };
}
// Returns a check of how the angle moves from the first key to the second: the share of the way that is done after a
// quarter of the time (`early`) and after three quarters (`late`).
std::function<bool(Stage&, const Seen&)> eases(double early, double late) {
  return [=](Stage& s, const Seen&) {
    const auto share = [&](int frame) {
      const Clip& clip = *shown_clip(s.editor().document());
      const glm::dquat q = value_at(fore(s.editor()), shapes_of(clip.keys, "Fore"), frame);
      return glm::length(turn_between(fore(s.editor()).at(10), q)) /
             glm::length(turn_between(fore(s.editor()).at(10), fore(s.editor()).at(30)));
    };
    return std::abs(share(15) - early) < 1e-9 && std::abs(share(25) - late) < 1e-9;
  };
}
std::function<void(Stage&)> with_other_handles() {
  return [](Stage& s) {
    in_graph({30})(s);
    run(s.editor(), "graph.handles_flat");
  };
}

struct GraphEditor : SmallEditor {
  GraphEditor() : SmallEditor({1280, 760}, {}, false) {
    open_graph(*editor, [this](const std::string& script) { play(script); });
    player.settle();
  }
  glm::vec2 point(int frame, int axis) { return graph_point(editor->timeline, {{kFore, axis}, frame}); }
  void drag(const glm::vec2& from, const glm::vec2& to) {
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
};

}  // namespace

std::vector<Proof> proofs_of_curves() {
  const auto choose = [](const char* id) { return std::string("click \"Motion/Curves/") + id + "\"\n wait-idle"; };
  const auto frames_are = [](const std::set<int>& frames) {
    return
        [=](Stage& s, const Seen&) { return key_frames_of(shown_clip(s.editor().document())->keys, kFore) == frames; };
  };
  const auto chosen_count = [](std::size_t count) {
    return [=](Stage& s, const Seen&) { return chosen_graph_keys(s.editor()).size() == count; };
  };
  const auto range = [](Stage& s) { return graph_of(s.editor()).high - graph_of(s.editor()).low; };
  return {
      {"graph.show", "click \"Motion/Curves/Graph editor\"\n wait-idle",
       [](Stage& s, const Seen&) { return !s.editor().timeline->shows_graph && !s.is("widget:timeline/graph"); },
       Shows::Nothing, "", in_graph()},
      {"graph.select", "drag graph 400 200 LMB", chosen_count(1), Shows::Nothing, "",
       [](Stage& s) {
         in_graph()(s);
         s.editor().timeline->window.low = 10;
         s.editor().timeline->window.count = 30;
         for (const int axis : {1, 2}) graph_of(s.editor()).hidden.insert({kFore, axis});
         graph_of(s.editor()).low = 20;
         graph_of(s.editor()).high = 80;
         s.play("wait-idle");
       }},
      {"graph.select_all", "key A", chosen_count(9), Shows::Nothing, "", in_graph()},
      {"graph.select_none", "key Alt+A", chosen_count(0), Shows::Nothing, "", in_graph({10, 30})},
      {"graph.pan", "drag graph 40 20 MMB",
       [](Stage& s, const Seen&) { return s.editor().timeline->window.low < -4 && graph_of(s.editor()).low > -3; },
       Shows::Nothing, "key Home", in_graph()},
      {"graph.zoom", "wheel graph 2",
       [=](Stage& s, const Seen&) { return s.editor().timeline->window.count < 50 && range(s) < 40; }, Shows::Nothing,
       "key Home", in_graph()},
      {"graph.zoom_time", "wheel graph 2 Ctrl",
       [=](Stage& s, const Seen&) { return s.editor().timeline->window.count < 50 && range(s) > 40; }, Shows::Nothing,
       "key Home", in_graph()},
      {"graph.zoom_values", "wheel graph 2 Shift",
       [=](Stage& s, const Seen&) { return s.editor().timeline->window.count > 50 && range(s) < 40; }, Shows::Nothing,
       "key Home", in_graph()},
      {"graph.view_all", "key Home",
       [=](Stage& s, const Seen&) {
         return graph_of(s.editor()).low < 0 && graph_of(s.editor()).high > 40 && range(s) < 60 &&
                s.editor().timeline->window.count > 50;
       },
       Shows::Nothing, "wheel graph 4", in_graph()},
      {"graph.view_selected", "key Num.",
       [=](Stage& s, const Seen&) {
         return graph_of(s.editor()).low > 10 && graph_of(s.editor()).high < 50 &&
                s.editor().timeline->window.low > 20 && s.editor().timeline->window.count < 40;
       },
       Shows::Nothing, "", in_graph({30, 50})},
      {"graph.move", "key G\n key 5\n key Return", frames_are({10, 35, 50}), Shows::Nothing, "", in_graph({30})},
      {"graph.scale", "key S\n key X\n key 2\n key Return", frames_are({20, 30, 100}), Shows::Nothing, "",
       in_graph({10, 50})},
      {"graph.duplicate", "key Shift+D\n key 5\n key Return", frames_are({10, 30, 35, 50}), Shows::Nothing, "",
       in_graph({30})},
      {"graph.delete", "key X", frames_are({10, 50}), Shows::Nothing, "", in_graph({30})},
      {"graph.interpolation_menu", "key T",
       [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Interpolation"; }, Shows::Nothing, "",
       in_graph({30})},
      {"graph.handle_menu", "key V", [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Handles"; },
       Shows::Nothing, "", in_graph({30})},
      {"graph.constant", choose("Interpolation/Constant"), goes_on(Interpolation::Constant), Shows::Nothing, "",
       in_graph({10})},
      {"graph.bezier", choose("Interpolation/Bezier"), goes_on(Interpolation::Bezier), Shows::Nothing, "",
       in_graph({10})},
      {"graph.linear", "key T\n wait-idle\n click Interpolation/Linear\n wait-idle", goes_on(Interpolation::Linear),
       Shows::Nothing, "",
       [](Stage& s) {
         in_graph({10, 30})(s);
         run(s.editor(), "graph.bezier");
         graph_of(s.editor()).chosen = {{{kFore, 0}, 10}};
       }},
      {"graph.ease_in", choose("Interpolation/Ease in"), eases(0.0625, 0.5625), Shows::Nothing, "", in_graph({10})},
      {"graph.ease_out", choose("Interpolation/Ease out"), eases(0.4375, 0.9375), Shows::Nothing, "", in_graph({10})},
      {"graph.ease_in_out", choose("Interpolation/Ease in and out"), eases(0.15625, 0.84375), Shows::Nothing, "",
       in_graph({10})},
      {"graph.handles_automatic", choose("Handles/Automatic"), handles_are(HandleKind::Automatic), Shows::Nothing, "",
       in_graph({30})},
      {"graph.handles_clamped", choose("Handles/Automatic, clamped"), handles_are(HandleKind::Clamped), Shows::Nothing,
       "", with_other_handles()},
      {"graph.handles_aligned", choose("Handles/Aligned"), handles_are(HandleKind::Aligned), Shows::Nothing, "",
       in_graph({30})},
      {"graph.handles_free", choose("Handles/Free"), handles_are(HandleKind::Free), Shows::Nothing, "", in_graph({30})},
      {"graph.handles_flat", "key V\n wait-idle\n click Handles/Flat\n wait-idle", handles_are(HandleKind::Flat),
       Shows::Nothing, "", in_graph({30})},
  };
}

TEST_CASE("operators: curves are shown and shaped") {
  Stage stage;
  prove(stage, proofs_of_curves());
}

TEST_CASE("graph: a dragged key changes its own channel and its frame, live, and undo takes it back") {
  GraphEditor test;
  const auto old = fore(*test.editor);
  const auto steps = test.editor->history->position();
  const glm::dvec3 before = angles(*test.editor, 30);
  go_to_frame(*test.editor, 30);
  const glm::vec2 key = test.point(30, 0);
  const Timeline& timeline = *test.editor->timeline;
  const float ten = graph_y(graph_of(*test.editor), 0) - graph_y(graph_of(*test.editor), 10);
  test.drag(key, key + glm::vec2(0, -ten));
  // While the button is down, nothing is committed, but the views show the new keys.
  CHECK(fore(*test.editor) == old);
  CHECK(bend_of(shown_pose(*test.editor)) > 45);
  test.release();
  CHECK(test.editor->history->position() == steps + 2);
  const glm::dvec3 after = angles(*test.editor, 30);
  CHECK(after.x == doctest::Approx(before.x + 10).epsilon(0.02));
  CHECK(std::abs(after.y - before.y) < 1e-9);
  CHECK(std::abs(after.z - before.z) < 1e-9);
  CHECK(test.fact("edit") == "Move keys in the graph");

  test.play("move graph\n key Home\n wait-idle");
  const glm::vec2 moved = test.point(30, 0);
  test.drag(moved, {x_of(timeline, 36), moved.y});
  test.release();
  CHECK(key_frames_of(shown_clip(test.editor->document())->keys, kFore) == std::set<int>{10, 36, 50});
  CHECK(fore(*test.editor).at(10) == old.at(10));
  CHECK(fore(*test.editor).at(50) == old.at(50));
  test.play("key Ctrl+Z\n wait-idle\n key Ctrl+Z\n wait-idle");
  CHECK(fore(*test.editor) == old);
}

TEST_CASE("graph: G with Y and a typed number turns by exactly so many degrees, and Escape by none") {
  GraphEditor test;
  graph_of(*test.editor).chosen = {{{kFore, 2}, 30}, {{kFore, 2}, 50}};
  test.play("key G\n key Y\n key 7\n key Return\n wait-idle");
  CHECK(angles(*test.editor, 30).z == doctest::Approx(7).epsilon(1e-9));
  CHECK(angles(*test.editor, 50).z == doctest::Approx(37).epsilon(1e-9));
  CHECK(angles(*test.editor, 50).x == doctest::Approx(20).epsilon(1e-9));
  const Keys now = shown_clip(test.editor->document())->keys;
  test.play("key G\n key 9\n wait-idle\n key Escape\n wait-idle");
  CHECK(shown_clip(test.editor->document())->keys == now);
  CHECK(chosen_graph_keys(*test.editor).size() == 2);
  CHECK(!graph_of(*test.editor).preview);
}

TEST_CASE("graph: a dragged handle sets the slope of its channel alone and makes the handles aligned") {
  GraphEditor test;
  graph_of(*test.editor).chosen = {{{kFore, 0}, 10}, {{kFore, 0}, 30}, {{kFore, 0}, 50}};
  run(*test.editor, "graph.bezier");
  graph_of(*test.editor).chosen = {{{kFore, 0}, 30}};
  test.player.settle();
  const auto handles = graph_handles(*test.editor);
  REQUIRE(handles.size() == 2);
  REQUIRE(handles[1].side == KeySide::Out);
  CHECK(handles[1].point.x == doctest::Approx(x_of(*test.editor->timeline, 30 + 20 / 3.0)));
  const auto speeds_before = graph_speeds(graph_of(*test.editor).curves, kFore, 30, KeySide::Out);
  const glm::vec2 up = handles[1].point + glm::vec2(0, -30);
  test.drag(handles[1].point, up);
  test.release();
  CHECK(shape(*test.editor, 30).handles == HandleKind::Aligned);
  CHECK(test.fact("edit") == "Move handle");
  const auto speeds = graph_speeds(graph_of(*test.editor).curves, kFore, 30, KeySide::Out);
  REQUIRE(speeds);
  const Graph& graph = graph_of(*test.editor);
  const double wanted = (graph_value_at(graph, up.y) - angles(*test.editor, 30).x) / (20 / 3.0);
  CHECK(speeds->x == doctest::Approx(wanted).epsilon(0.01));
  CHECK(std::abs(speeds->y - speeds_before->y) < 1e-9);
  CHECK(std::abs(speeds->z - speeds_before->z) < 1e-9);
  // Computes the slope of the played curve by a difference over a small step.
  const Keys& keys = shown_clip(test.editor->document())->keys;
  const auto x_at = [&](double frame) {
    return glm::degrees(channel_angles(value_at(fore(*test.editor), shapes_of(keys, "Fore"), frame)).x);
  };
  CHECK((x_at(30 + 1e-4) - x_at(30 - 1e-4)) / 2e-4 == doctest::Approx(wanted).epsilon(0.01));
  test.play("key Ctrl+Z\n wait-idle");
  CHECK(shape(*test.editor, 30).handles == HandleKind::Clamped);
}

TEST_CASE("graph: over a motion the curve is what plays, and the motion's own curve lies below") {
  GraphEditor test;
  Document document = bending_limb();
  Clip clip = *document.clips[0];
  clip.keys.bones["Fore"] = {{10, turned(40, 0, 0)}, {40, turned(40, 0, 0)}};
  document.clips = {std::make_shared<const Clip>(clip)};
  test.editor->history->reset(std::move(document), "Open limb");
  test.player.settle();
  const GraphCurve& curve = graph_of(*test.editor).curves.tracks.at(kFore);
  REQUIRE(curve.values.size() == 61);
  REQUIRE(curve.motion.size() == 61);
  const ClipOnRig played(test.editor->document().clips[0], test.editor->document().armature);
  for (int frame = 0; frame <= 60; ++frame) {
    CHECK(curve.values[frame].x == doctest::Approx(bend_of(played.at(frame))).epsilon(1e-9));
    CHECK(curve.motion[frame].x == doctest::Approx(frame).epsilon(1e-6));
  }
}

TEST_CASE("graph: curves do not jump where an angle goes beyond half a turn") {
  GraphEditor test;
  Document document = test.editor->document();
  Clip clip = *document.clips[0];
  clip.keys.bones["Fore"] = {
      {0, turned(0, 0, 0)}, {20, turned(170, 0, 0)}, {40, turned(340, 0, 0)}, {60, turned(510, 0, 0)}};
  document.clips = {std::make_shared<const Clip>(clip)};
  test.editor->history->reset(std::move(document), "Open limb");
  test.player.settle();
  const GraphCurve& curve = graph_of(*test.editor).curves.tracks.at(kFore);
  for (int frame = 0; frame <= 60; ++frame) CHECK(curve.values[frame].x == doctest::Approx(8.5 * frame).epsilon(1e-6));
}

TEST_CASE("graph: a channel's button hides its curve and its keys, and Ctrl leaves it alone") {
  GraphEditor test;
  test.play("click \"timeline/channels/Fore/X\"\n wait-idle\n move graph\n key A\n wait-idle");
  CHECK(chosen_graph_keys(*test.editor).size() == 6);
  test.play("click \"timeline/channels/Fore/X\" Ctrl\n wait-idle\n move graph\n key Alt+A\n key A\n wait-idle");
  CHECK(chosen_graph_keys(*test.editor).size() == 3);
}

TEST_CASE("graph: rows and buttons stand inside the area and beside one another at every size") {
  for (const auto& [size, scale] :
       {std::pair<glm::ivec2, double>{{1280, 720}, 1}, {{2560, 1440}, 2}, {{1024, 640}, 1}}) {
    CAPTURE(size.x);
    Preferences preferences;
    preferences.scale = scale;
    SmallEditor test(size, preferences, false);
    open_graph(*test.editor, [&](const std::string& script) { test.play(script); });
    test.editor->selection->bones = {0, 1};
    test.player.settle();
    const auto& widgets = test.editor->ui->widgets.widgets();
    int in_graph = 0;
    for (const Widget& widget : widgets) {
      if (widget.region != Region::Bottom) continue;
      in_graph += widget.name.ends_with("/X");
      CHECK(test.editor->screen->layout.bottom.contains(intersection(widget.rect, test.editor->screen->layout.bottom)));
      for (const Widget& other : widgets)
        if (other.region == Region::Bottom && other.name != widget.name) CHECK_FALSE(widget.rect.overlaps(other.rect));
    }
    CHECK(in_graph >= 2);
  }
}

TEST_CASE("graph: a root bone has its shift as well, whose values are mm") {
  GraphEditor test;
  Document document = test.editor->document();
  Clip clip = *document.clips[0];
  clip.keys.root = {{0, {0, 0, 0}}, {40, {100, -20, 5}}};
  set_root_shape(clip.keys, 0, {.next = Interpolation::Bezier});
  document.clips = {std::make_shared<const Clip>(clip)};
  test.editor->history->reset(std::move(document), "Open limb");
  test.editor->selection->bone = 0;
  test.editor->selection->bones = {0};
  test.player.settle();
  const GraphTrack shift{test.editor->document().armature->bones[0].name, true};
  CHECK(!is_shown(graph_of(*test.editor), {shift, 1}));
  test.play("click \"timeline/channels/" + shift.bone + " shift/Y\"\n wait-idle");
  CHECK(is_shown(graph_of(*test.editor), {shift, 1}));
  const GraphCurve& curve = graph_of(*test.editor).curves.tracks.at(shift);
  // Between flat ends, the cubic is the smoothstep function.
  for (int frame = 0; frame <= 40; ++frame) {
    const double t = frame / 40.0;
    CHECK(curve.values[frame].x == doctest::Approx(100 * t * t * (3 - 2 * t)).epsilon(1e-9));
  }
  graph_of(*test.editor).chosen = {{{shift, 1}, 40}};
  test.play("move graph\n key G\n key Y\n key -\n key 5\n key Return\n wait-idle");
  CHECK(glm::distance(shown_clip(test.editor->document())->keys.root.at(40), glm::dvec3(100, -25, 5)) < 1e-9);
}

TEST_CASE("graph: a clip resampled to twice the rate keeps its curves in time") {
  GraphEditor test;
  graph_of(*test.editor).chosen = {{{kFore, 0}, 10}, {{kFore, 0}, 30}, {{kFore, 0}, 50}};
  run(*test.editor, "graph.bezier");
  run(*test.editor, "graph.handles_automatic");
  run(*test.editor, "graph.handles_aligned");
  const auto played = [&] { return ClipOnRig(test.editor->document().clips[0], test.editor->document().armature); };
  const ClipOnRig before = played();
  test.play(
      "click \"Motion/Clip/Resample clip...\"\n wait-idle\n double-click \"Frame rate/value\"\n key Ctrl+A\n type 60\n "
      "key Return\n key Return\n wait-idle");
  REQUIRE(shown_clip(test.editor->document())->rate == 60);
  CHECK(key_frames_of(shown_clip(test.editor->document())->keys, kFore) == std::set<int>{20, 60, 100});
  const ClipOnRig after = played();
  for (int frame = 0; frame <= 60; ++frame)
    CHECK(std::abs(glm::dot(after.at(2 * frame).rotation[1], before.at(frame).rotation[1])) > 1 - 1e-12);
}

TEST_CASE("graph: Escape during a drag leaves keys, selection and the shown pose as they were") {
  GraphEditor test;
  const Keys keys = shown_clip(test.editor->document())->keys;
  go_to_frame(*test.editor, 30);
  test.player.settle();
  const double bend = bend_of(shown_pose(*test.editor));
  const auto steps = test.editor->history->position();
  const glm::vec2 key = test.point(30, 0);
  test.drag(key, key + glm::vec2(30, 40));
  CHECK(std::abs(bend_of(shown_pose(*test.editor)) - bend) > 1);
  test.play("key Escape");
  test.release();
  CHECK(shown_clip(test.editor->document())->keys == keys);
  CHECK(bend_of(shown_pose(*test.editor)) == doctest::Approx(bend));
  CHECK(test.editor->history->position() == steps);
  CHECK(!graph_of(*test.editor).preview);
}

TEST_CASE("graph: S scales values about their middle, and time about the play head with the slopes of handles") {
  GraphEditor test;
  graph_of(*test.editor).chosen = {{{kFore, 0}, 10}, {{kFore, 0}, 30}, {{kFore, 0}, 50}};
  run(*test.editor, "graph.bezier");
  run(*test.editor, "graph.handles_automatic");
  run(*test.editor, "graph.handles_free");
  test.player.settle();
  const ClipOnRig before(test.editor->document().clips[0], test.editor->document().armature);
  test.play("move graph\n key S\n key X\n key 3\n key Return\n wait-idle");
  CHECK(test.fact("edit") == "Scale keys in the graph");
  CHECK(key_frames_of(shown_clip(test.editor->document())->keys, kFore) == std::set<int>{30, 90, 150});
  const ClipOnRig after(test.editor->document().clips[0], test.editor->document().armature);
  for (int frame = 0; frame <= 60; ++frame)
    CHECK(std::abs(glm::dot(after.at(3 * frame).rotation[1], before.at(frame).rotation[1])) > 1 - 1e-12);
  test.play("key Ctrl+Z\n wait-idle");
  graph_of(*test.editor).chosen = {{{kFore, 0}, 10}, {{kFore, 0}, 30}, {{kFore, 0}, 50}};
  test.play("move graph\n key S\n key Y\n key 2\n key Return\n wait-idle");
  CHECK(key_frames_of(shown_clip(test.editor->document())->keys, kFore) == std::set<int>{10, 30, 50});
  CHECK(angles(*test.editor, 10).x == doctest::Approx(-20));
  CHECK(angles(*test.editor, 30).x == doctest::Approx(60));
  CHECK(angles(*test.editor, 30).y == doctest::Approx(10));
  CHECK(angles(*test.editor, 50).x == doctest::Approx(20));
}

}  // namespace limber::test
