// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the test pose, in which the views show the body while the user paints weights. The test pose is the rest
// pose or the project's pose, with one joint bent in addition.
#include "editor/shown/test_pose.h"

#include "editor/context/operator.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  return seen_weights(editor) ? "" : "Compute the weights first";
}

std::string needs_bend(const Editor& editor) {
  const std::string why = needs_weights(editor);
  return !why.empty() ? why : editor.trial->degrees == 0 ? "No joint is bent in the test pose" : "";
}

}  // namespace

std::vector<Operator> test_pose_operators() {
  return {
      {"skin.posed", "Test pose", icon::kPose, "Test pose",
       "Switch between the rest pose and the test pose, which is the project's pose or one bent joint. You can paint "
       "in both.",
       toggle_test_pose, needs_weights, [](const Editor& e) { return e.trial->posed; }},
      {"skin.bend_by_wheel", "Bend by wheel", "", "Test pose",
       "Bend the active bone in the test pose by a step of the mouse wheel.",
       [](Editor& e) { set_bend(e, bend(e) + TestPose::kStep * e.input.wheel); }, why_not_bend},
      {"skin.bend_more", "Bend further", "", "Test pose",
       "Bend the active bone in the test pose; the project's pose does not change.",
       [](Editor& e) { set_bend(e, bend(e) + TestPose::kStep); }, why_not_bend},
      {"skin.bend_less", "Bend less", "", "Test pose", "Bend the active bone in the test pose in the other direction.",
       [](Editor& e) { set_bend(e, bend(e) - TestPose::kStep); }, why_not_bend},
      {"skin.unbend", "Unbend", "", "Test pose", "Straighten the joint that is bent in the test pose.", clear_bend,
       needs_bend},
  };
}

}  // namespace limber::editor
