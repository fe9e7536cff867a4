// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits keys in the graph editor and the timeline: effects on slopes, on top of a motion, and when another clip is
// shown in the meantime.
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/motion/graph_edits.h"

#include <cmath>

#include "core/motion/euler_channels.h"
#include "core/motion/key_curve.h"
#include "editor/files/project_session.h"
#include "editor/motion/graph_tool.h"
#include "editor/motion/timeline_tool.h"
#include "tests/editor/small_clip.h"
#include "tests/editor/small_editor.h"

namespace limber::test {

using namespace editor;

namespace {

const GraphTrack kFore{"Fore", false};

glm::dquat turned(double x, double y, double z) { return rotation_of_channels(glm::radians(glm::dvec3(x, y, z))); }

// Returns the curves of one bone without a motion.
GraphCurves curves_of(const Keys& keys) {
  GraphCurves curves;
  GraphCurve& curve = curves.tracks[kFore];
  curve.rotations = curve.turns = keys.bones.at("Fore");
  curve.shapes = shapes_of(keys, "Fore");
  return curves;
}
std::set<GraphKey> channel_keys(const Keys& keys, int axis) {
  std::set<GraphKey> all;
  for (const auto& [frame, rotation] : keys.bones.at("Fore")) all.insert({{kFore, axis}, frame});
  return all;
}

// Returns the angle of a bone's curve about an axis at a frame, degrees.
double angle_at(const Keys& keys, double frame, int axis) {
  return glm::degrees(channel_angles(value_at(keys.bones.at("Fore"), shapes_of(keys, "Fore"), frame))[axis]);
}

// Shows a clip without a motion in the timeline; its lower bone has keys with slopes set by hand.
Keys shaped_keys() {
  Keys keys;
  keys.bones["Fore"] = {{10, turned(0, 0, 0)}, {30, turned(40, 0, 0)}, {50, turned(20, 0, 0)}};
  set_shape(keys, "Fore", 10, {Interpolation::Bezier, HandleKind::Free, {0.01, 0, 0}, {0.05, 0, 0}});
  set_shape(keys, "Fore", 30, {Interpolation::Linear, HandleKind::Free, {-0.04, 0, 0}, {0.02, 0, 0}});
  set_shape(keys, "Fore", 50, {Interpolation::Constant, HandleKind::Aligned, {0.03, 0, 0}, {0.03, 0, 0}});
  return keys;
}

struct KeyEditor : SmallEditor {
  KeyEditor() : SmallEditor({1280, 760}, {}, false) { show(shaped_keys(), false); }

  void show(const Keys& keys, bool graph) {
    Document document = bending_limb();
    Clip clip{.name = "keys", .range_end = 60};
    clip.keys = keys;
    document.clips = {std::make_shared<const Clip>(clip)};
    document.frame = 0;
    document.pose = nullptr;
    open(std::move(document), graph);
  }
  void open(Document document, bool graph) {
    editor->history->reset(std::move(document), "Open limb");
    editor->timeline->graph.reset();
    editor->timeline->shows_graph = false;
    editor->selection->bone = 1;
    editor->selection->bones = {1};
    play("key Ctrl+3\n wait-idle");
    if (graph) run(*editor, "graph.show");
    player.settle();
    play(graph ? "move graph\n wait-idle" : "move keys\n wait-idle");
  }
  const Keys& keys() { return shown_clip(editor->document())->keys; }
};

}  // namespace

TEST_CASE("graph: values scaled to nothing lie still between their keys, whatever their slopes were") {
  const Keys keys = shaped_keys();
  const Keys flat = with_keys_changed(curves_of(keys), keys, channel_keys(keys, 0), {}, {0, 0});
  for (double frame = 10; frame <= 50; frame += 0.5) CHECK(std::abs(angle_at(flat, frame, 0)) < 1e-9);
  const Keys doubled = with_keys_changed(curves_of(keys), keys, channel_keys(keys, 0), {}, {2, 0});
  for (double frame = 10; frame <= 50; frame += 0.5)
    CHECK(angle_at(doubled, frame, 0) == doctest::Approx(2 * angle_at(keys, frame, 0)).epsilon(1e-9));
}

TEST_CASE("graph: a key that is turned about one axis keeps the slopes of its angles") {
  Keys keys;
  keys.bones["Fore"] = {{0, turned(-20, 0, 0)}, {20, turned(30, 10, 0)}, {40, turned(60, 0, 0)}};
  for (const int frame : {0, 20, 40})
    set_shape(keys, "Fore", frame, {Interpolation::Bezier, HandleKind::Free, {0.03, 0.01, 0}, {0.05, -0.01, 0.02}});
  const auto slopes = [](const Keys& of, double from, double to) {
    return glm::dvec3(angle_at(of, to, 0) - angle_at(of, from, 0), angle_at(of, to, 1) - angle_at(of, from, 1),
                      angle_at(of, to, 2) - angle_at(of, from, 2)) /
           (to - from);
  };
  const Keys after = with_keys_changed(curves_of(keys), keys, {{{kFore, 2}, 20}}, {}, {1, 70});
  CHECK(angle_at(after, 20, 2) == doctest::Approx(70));
  // Compares the slopes of the played curves, by differences over small steps.
  CHECK(glm::distance(slopes(after, 20 - 1e-4, 20), slopes(keys, 20 - 1e-4, 20)) < 1e-3);
  CHECK(glm::distance(slopes(after, 20, 20 + 1e-4), slopes(keys, 20, 20 + 1e-4)) < 1e-3);
}

TEST_CASE("graph: keys are copied with their slopes, and the keys themselves stay") {
  const Keys keys = shaped_keys();
  const Keys more = with_keys_copied(curves_of(keys), keys, channel_keys(keys, 0), {1, 100}, {1, 5});
  REQUIRE(more.bones.at("Fore").size() == 6);
  for (const int frame : {10, 30, 50}) {
    CHECK(more.bones.at("Fore").at(frame) == keys.bones.at("Fore").at(frame));
    CHECK(shape_at(shapes_of(more, "Fore"), frame) == shape_at(shapes_of(keys, "Fore"), frame));
    CHECK(angle_at(more, frame + 100, 0) == doctest::Approx(angle_at(keys, frame, 0) + 5));
    CHECK(shape_at(shapes_of(more, "Fore"), frame + 100).next == shape_at(shapes_of(keys, "Fore"), frame).next);
  }
}

TEST_CASE("timeline: scaled keys play the same curve slower, and backwards with a negative factor") {
  KeyEditor test;
  const auto played = [&] { return ClipOnRig(test.editor->document().clips[0], test.editor->document().armature); };
  const ClipOnRig before = played();
  for (const auto& [typed, factor] : {std::pair<const char*, int>{"key 3", 3}, {"key -\n key 2", -2}}) {
    CAPTURE(factor);
    test.editor->timeline->chosen = {10, 30, 50};
    test.play(std::string("move keys\n key S\n ") + typed + "\n key Return\n wait-idle");
    CHECK(frames_of(test.keys()) == std::set<int>{10 * factor, 30 * factor, 50 * factor});
    const ClipOnRig after = played();
    for (int frame = 10; frame <= 50; ++frame) {
      if (frame == 30 && factor < 0) continue;
      CHECK(bend_of(after.at(frame * factor)) == doctest::Approx(bend_of(before.at(frame))).epsilon(1e-9));
    }
    test.play("key Ctrl+Z\n wait-idle");
  }
}

TEST_CASE("graph: a key beyond the sampled part of a motion is moved by exactly so many degrees") {
  KeyEditor test;
  Document document = bending_limb();
  Clip clip = *document.clips[0];
  clip.start = 25'000;
  clip.range_start = 0;
  clip.range_end = 26'000;
  clip.keys.bones["Fore"] = {{100, turned(0, 0, 0)}, {25'040, turned(10, 0, 0)}};
  document.clips = {std::make_shared<const Clip>(clip)};
  test.open(std::move(document), true);
  graph_of(*test.editor).chosen = {{{kFore, 0}, 25'040}};
  test.play("key G\n key Y\n key 5\n key Return\n wait-idle");
  CHECK(glm::degrees(channel_angles(test.keys().bones.at("Fore").at(25'040))).x == doctest::Approx(15));
}

TEST_CASE("graph: a tool in use ends when another clip is shown, or none, and changes neither") {
  for (const bool none : {false, true}) {
    KeyEditor test;
    test.show(shaped_keys(), true);
    graph_of(*test.editor).chosen = {{{kFore, 0}, 30}};
    test.play("key G\n key 5\n wait-idle");
    REQUIRE(test.editor->interaction->modal);
    Document next = test.editor->document();
    if (none) next.clips.clear();
    else add_clip(next, Clip{.name = "other"});
    test.editor->history->commit("Make a clip", next);
    test.player.settle();
    CHECK(!test.editor->interaction->modal);
    CHECK(!graph_of(*test.editor).preview);
    CHECK(test.editor->document() == next);
  }
}

TEST_CASE("timeline: a tool in use ends when another clip is shown, or none, and changes neither") {
  for (const bool none : {false, true}) {
    KeyEditor test;
    test.editor->timeline->chosen = {30};
    test.play("move keys\n key G\n key 5\n wait-idle");
    REQUIRE(!test.editor->timeline->moving.empty());
    Document next = test.editor->document();
    Clip other{.name = "other"};
    other.keys = shaped_keys();
    if (none) next.clips.clear();
    else add_clip(next, other);
    test.editor->history->commit("Make a clip", next);
    test.play("key Return\n wait-idle");
    CHECK(!test.editor->interaction->modal);
    CHECK(test.editor->timeline->moving.empty());
    CHECK(test.editor->document() == next);
  }
}

TEST_CASE("graph: a drag ends without a change when another clip is shown") {
  KeyEditor test;
  test.show(shaped_keys(), true);
  const glm::vec2 key = graph_point(test.editor->timeline, {{kFore, 0}, 30});
  test.host->events.push(PointerMoved{key});
  test.player.step();
  test.host->events.push(ButtonChanged{MouseButton::Left, true});
  test.player.step();
  test.host->events.push(PointerMoved{key + glm::vec2(60, 10)});
  test.player.step();
  REQUIRE(graph_of(*test.editor).preview);
  Document next = test.editor->document();
  add_clip(next, Clip{.name = "other"});
  test.editor->history->commit("Make a clip", next);
  test.host->events.push(PointerMoved{key + glm::vec2(80, 10)});
  test.player.step();
  test.host->events.push(ButtonChanged{MouseButton::Left, false});
  test.player.settle();
  CHECK(test.editor->document() == next);
}

TEST_CASE("project: what the pointer does ends when another project opens") {
  KeyEditor test;
  test.show(shaped_keys(), true);
  graph_of(*test.editor).chosen = {{{kFore, 0}, 30}};
  test.play("key G\n key 5\n wait-idle");
  REQUIRE(test.editor->interaction->modal);
  const auto opened = std::make_shared<Opened>();
  opened->label = "New project";
  opened->agreed = test.editor->history->revision();
  replace_project(*test.editor, opened);
  CHECK(!test.editor->interaction->modal);
  CHECK(!graph_of(*test.editor).preview);
  test.player.settle();
  CHECK(test.editor->document().clips.empty());
}

TEST_CASE("graph: undo and redo of a move select the moved keys where they are") {
  KeyEditor test;
  test.show(shaped_keys(), true);
  const std::set<GraphKey> before = {{{kFore, 0}, 30}}, after = {{{kFore, 0}, 36}};
  graph_of(*test.editor).chosen = before;
  test.play("key G\n key 6\n key Return\n wait-idle");
  CHECK(chosen_graph_keys(*test.editor) == after);
  test.play("key Ctrl+Z\n wait-idle");
  CHECK(chosen_graph_keys(*test.editor) == before);
  test.play("key Shift+Ctrl+Z\n wait-idle");
  CHECK(chosen_graph_keys(*test.editor) == after);
}

TEST_CASE("graph: a body with two root bones has one shift, which is moved once") {
  KeyEditor test;
  Document document = bending_limb();
  Armature rig = *document.armature;
  rig.bones.push_back({"Other", -1, {0, 0, 0}, {0, 0, 10}});
  document.armature = std::make_shared<const Armature>(rig);
  document.volume = nullptr;
  document.weights = nullptr;
  Clip clip{.name = "keys", .range_end = 60};
  clip.keys.root = {{10, {1, 2, 3}}, {20, {4, 5, 6}}};
  document.clips = {std::make_shared<const Clip>(clip)};
  document.pose = nullptr;
  test.open(std::move(document), true);
  test.editor->selection->bones = {0, 2};
  test.player.settle();
  graph_of(*test.editor).hidden.clear();
  run(*test.editor, "graph.select_all");
  test.play("key G\n key X\n key 1\n key 0\n key Return\n wait-idle");
  CHECK(test.keys().root == std::map<int, glm::dvec3>{{20, {1, 2, 3}}, {30, {4, 5, 6}}});
}

TEST_CASE("graph: keys of the rows that it hides are not changed by the timeline's keys") {
  KeyEditor test;
  test.play("move keys\n key A\n wait-idle");
  CHECK(test.editor->timeline->chosen.size() == 3);
  const Keys keys = test.keys();
  run(*test.editor, "graph.show");
  test.player.settle();
  CHECK(test.editor->timeline->chosen.empty());
  test.play("move ruler\n key A\n wait-idle\n key X\n wait-idle");
  CHECK(test.keys() == keys);
}

TEST_CASE("graph: the area below gets its height back in the workspace in which the graph was shown") {
  KeyEditor test;
  const Arrangements before = test.editor->screen->arrangements;
  run(*test.editor, "graph.show");
  test.player.settle();
  CHECK(test.editor->screen->arrangement().bottom_height > before[2].bottom_height);
  test.play("key Ctrl+1\n wait-idle");
  run(*test.editor, "graph.show");  // the timeline is hidden in this workspace, so this shows the graph
  run(*test.editor, "graph.show");
  test.player.settle();
  for (std::size_t i = 0; i < before.size(); ++i)
    CHECK(test.editor->screen->arrangements[i].bottom_height == before[i].bottom_height);
}

TEST_CASE("graph: the console hides it, and its tools refuse until it is shown again") {
  KeyEditor test;
  test.show(shaped_keys(), true);
  graph_of(*test.editor).chosen = {{{kFore, 0}, 30}};
  test.editor->screen->arrangement().console = true;
  test.player.settle();
  const auto why = [&] { return disabled_reason(*test.editor, *find_operator(test.editor->operators, "graph.move")); };
  CHECK(why() == "Show the graph editor first");
  run(*test.editor, "graph.show");
  CHECK(!test.editor->screen->arrangement().console);
  CHECK(why().empty());
}

TEST_CASE("graph: a shift of 1e17 mm is drawn") {
  KeyEditor test;
  Keys keys;
  keys.root = {{10, {1e17, 0, 0}}};
  test.show(keys, false);
  test.editor->selection->bones = {0};
  run(*test.editor, "graph.show");
  test.player.settle();
  const std::string bone = test.editor->document().armature->bones[0].name;
  graph_of(*test.editor).hidden = {
      {{bone, false}, 0}, {{bone, false}, 1}, {{bone, false}, 2}, {{bone, true}, 1}, {{bone, true}, 2}};
  fit_graph_values(*test.editor);
  test.player.settle();
  CHECK(graph_of(*test.editor).high > graph_of(*test.editor).low);
}

}  // namespace limber::test
