// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the test pose, in which the views show the body while the user paints weights. The test pose is the rest
// pose or the project's pose, with one joint bent in addition.
#include "editor/context/context.h"
#include "editor/context/workspace.h"
#include "editor/shown/test_pose.h"
#include "editor/ui/ui.h"

#include "editor/context/operator.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  return seen_weights(context) ? "" : "Compute the weights first";
}

std::string needs_bend(const Context& context) {
  const std::string why = needs_weights(context);
  return !why.empty()                  ? why
         : context.trial->degrees == 0 ? "No joint is bent in the test pose: bend a joint first"
                                       : "";
}

}  // namespace

std::vector<Operator> test_pose_operators() {
  return {
      {"skin.posed", "Test pose", icon::kPose, "Test pose",
       "Switch between the rest pose and the test pose, which is the project's pose or one bent joint. You can paint "
       "in both.",
       toggle_test_pose, needs_weights, [](const Context& c) { return c.trial->posed; }},
      {"skin.bend_by_wheel", "Bend by wheel", "", "Test pose",
       "Bend the active bone in the test pose by a step of the mouse wheel.",
       [](Context& c) { set_bend(c, bend(c) + TestPose::kStep * c.ui->input.wheel); }, why_not_bend},
      {"skin.bend_more", "Bend further", "", "Test pose",
       "Bend the active bone in the test pose; the project's pose does not change.",
       [](Context& c) { set_bend(c, bend(c) + TestPose::kStep); }, why_not_bend},
      {"skin.bend_less", "Bend less", "", "Test pose", "Bend the active bone in the test pose in the other direction.",
       [](Context& c) { set_bend(c, bend(c) - TestPose::kStep); }, why_not_bend},
      {"skin.unbend", "Unbend", "", "Test pose", "Straighten the joint that is bent in the test pose.", clear_bend,
       needs_bend},
  };
}

}  // namespace limber::editor
