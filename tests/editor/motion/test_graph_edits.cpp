// SPDX-License-Identifier: AGPL-3.0-or-later
// Changes of keys through the graph editor and the timeline: what they do to slopes, over a motion, and when another
// clip is shown in the meantime.
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

// Curves of one bone without a motion.
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

// The angles of a bone's curve about an axis at a frame, degrees.
double angle_at(const Keys& keys, double frame, int axis) {
  return glm::degrees(channel_angles(value_at(keys.bones.at("Fore"), shapes_of(keys, "Fore"), frame))[axis]);
}

// A clip without a motion whose lower bone has keys with hand-set slopes, seen in the timeline.
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
    editor->history.reset(std::move(document), "Open limb");
    editor->timeline->graph.reset();
    editor->timeline->shows_graph = false;
    editor->selection.bone = 1;
    editor->selection.bones = {1};
    play("key Ctrl+3\n wait-idle");
    if (graph) run(*editor, "graph.show");
    player.settle();
    play(graph ? "move graph\n wait-idle" : "move keys\n wait-idle");
  }
  const Keys& keys() { return shown_clip(*editor)->keys; }
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
  // By differences over small steps, from the curves that play.
  CHECK(glm::distance(slopes(after, 20 - 1e-4, 20), slopes(keys, 20 - 1e-4, 20)) < 1e-3);
  CHECK(glm::distance(slopes(after, 20, 20 + 1e-4), slopes(keys, 20, 20 + 1e-4)) < 1e-3);
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

}  // namespace limber::test
