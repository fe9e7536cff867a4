// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the tools that transform bones, and the operators that blend a pose with other poses.
#include "editor/context/transform_settings.h"
#include "editor/pose/pose_edits.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

using Effect = std::function<bool(Stage&, const Seen&)>;

void choose_fore(Stage& s) {
  *s.editor().selection = {};
  s.editor().selection->bone = 1;
  s.editor().selection->bones = {1};
  s.play("key Ctrl+3\n move \"3D view/view\"\n wait-idle");
}

Effect tool_is(const char* tool) {
  return [=](Stage& s, const Seen&) { return s.is("tool", tool); };
}

Effect space_is(Space space) {
  return [=](Stage& s, const Seen&) { return s.editor().transform_settings->space == space; };
}

// Returns a check of the last edit's name and of the angle by which the forelimb is bent, degrees.
Effect bent(const char* edit, double degrees) {
  return [=](Stage& s, const Seen& before) {
    const double angle = glm::degrees(glm::angle(pose_of(s.document()).rotation[1]));
    return s.is("edit", edit) && static_cast<int>(s.editor().history->position()) == before.position + 1 &&
           std::abs(angle - degrees) < 0.01;
  };
}

}  // namespace

std::vector<Proof> proofs_of_handling() {
  return {
      {"tool.rotate", "click \"strip/tool.rotate\"", tool_is("rotate"), Shows::Nothing, "", choose_fore},
      {"tool.extrude", "click \"strip/tool.extrude\"", tool_is("extrude"), Shows::Nothing, "key Ctrl+1\n wait-idle"},
      {"tool.move", "click \"strip/tool.move\"", tool_is("move"), Shows::Nothing, "", choose_fore},
      {"tool.reach", "click \"strip/tool.reach\"", tool_is("reach")},
      {"space.local", "click \"Edit/Axes/Local axes\"", space_is(Space::Local)},
      {"space.parent", "click \"Edit/Axes/Parent axes\"", space_is(Space::Parent)},
      {"space.view", "click \"Edit/Axes/View axes\"", space_is(Space::View)},
      {"space.global", "click \"Edit/Axes/Global axes\"", space_is(Space::Global)},
      {"edit.x_mirror", "click \"Edit/Pose/X-mirror\"",
       [](Stage& s, const Seen&) { return s.editor().transform_settings->x_mirror; }},
      {"pose.auto_ik", "click \"Edit/IK/Auto-IK\"",
       [](Stage& s, const Seen&) { return !s.editor().transform_settings->auto_ik; }},
      {"pose.pin", "key Shift+P", [](Stage& s, const Seen&) { return anchors_of(s.document()).pins.contains("Fore"); },
       Shows::Nothing, "", choose_fore},
      {"pose.pole", "click \"Edit/IK/IK pole\"",
       [](Stage& s, const Seen&) { return anchors_of(s.document()).poles.contains("Fore"); }},
      {"pose.clear_ik", "key Ctrl+Alt+I",
       [](Stage& s, const Seen& b) {
         return !b.document.anchors->pins.empty() && anchors_of(s.document()) == Anchors{} && s.is("edit", "Clear IK");
       },
       Shows::Nothing, "", choose_fore},
      {"pose.add_ik", "key Shift+I",
       [](Stage& s, const Seen&) {
         return anchors_of(s.document()).pins.contains("Fore") && anchors_of(s.document()).poles.contains("Fore");
       },
       Shows::Nothing, "", choose_fore},
      {"pose.push", "key Ctrl+E\n key 2\n key 0\n key Return", bent("Push pose", 36), Shows::InBody,
       "key R\n key X\n key 3\n key 0\n key Return", choose_fore},
      {"pose.relax", "key Alt+E\n key 5\n key 0\n key Return", bent("Relax pose", 18), Shows::InBody},
      {"pose.breakdown", "key Shift+E\n key Return", bent("Breakdown", 9), Shows::InBody},
      {"pose.blend_copied", "click \"Edit/Pose/Blend to copied pose\"\n key 5\n key 0\n key Return",
       bent("Blend to copied pose", 7), Shows::InBody,
       "key Alt+R\n key R\n key X\n key 5\n key Return\n key Ctrl+C\n key R\n key X\n key 4\n key Return"},
      {"pose.blend_rest", "click \"Edit/Pose/Blend to rest\"\n key 1\n key 0\n key 0\n key Return",
       bent("Blend to rest", 0), Shows::InBody, "", choose_fore},
  };
}

TEST_CASE("operators: bones are taken hold of, and poses drawn towards others") {
  Stage stage;
  prove(stage, proofs_of_handling());
}

}  // namespace limber::test
