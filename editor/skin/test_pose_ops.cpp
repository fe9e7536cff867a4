// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose in which weights are painted.
#include "editor/shown/test_pose.h"

#include "editor/context/operator.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
  return seen_weights(editor) ? "" : "Compute the weights first";
}

std::string needs_bend(const Editor& editor) {
  const std::string why = needs_weights(editor);
  return !why.empty() ? why : editor.trial->degrees == 0 ? "No joint is bent on trial" : "";
}

}  // namespace

std::vector<Operator> test_pose_operators() {
  return {
      {"skin.posed", "Posed", icon::kPose, "Test pose",
       "Shows the body in its pose while its weights are painted; once more at rest, a joint bent on trial too, and "
       "back. Strokes land where the pointer is seen.",
       toggle_test_pose, needs_weights, [](const Editor& e) { return e.trial->posed; }},
      {"skin.bend_by_wheel", "Bend by wheel", "", "Test pose",
       "Bends the active bone on trial, by a step of the wheel.",
       [](Editor& e) { set_bend(e, bend(e) + TestPose::kStep * e.input.wheel); }, why_not_bend},
      {"skin.bend_more", "Bend further", "", "Test pose",
       "Bends the active bone on trial; the pose of the project stays.",
       [](Editor& e) { set_bend(e, bend(e) + TestPose::kStep); }, why_not_bend},
      {"skin.bend_less", "Bend less", "", "Test pose", "Bends the active bone on trial the other way.",
       [](Editor& e) { set_bend(e, bend(e) - TestPose::kStep); }, why_not_bend},
      {"skin.unbend", "Unbend", "", "Test pose", "The joint that is bent on trial goes back.", clear_bend, needs_bend},
  };
}

}  // namespace limber::editor
