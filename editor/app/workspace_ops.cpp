// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/screen.h"
#include "editor/resample/results.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

void go_to(Context& context, Workspace workspace) {
  const bool stays = context.workspace() == workspace;
  context.screen->workspace = workspace;
  if (workspace == Workspace::Resample && !stays) show_result_of_pose(context);
}

Operator to_workspace(const char* id, const char* label, const char* icon, const char* description,
                      Workspace workspace) {
  return {id,          label,
          icon,        "Workspace",
          description, [workspace](Context& c) { go_to(c, workspace); },
          nullptr,     [workspace](const Context& c) { return c.workspace() == workspace; }};
}

Operator by_step(const char* id, const char* label, int step) {
  return {id, label, "", "Workspace", "Switch to the previous or next workspace of the top bar.", [step](Context& c) {
            go_to(c, static_cast<Workspace>((static_cast<int>(c.workspace()) + step + 4) % 4));
          }};
}

}  // namespace

std::vector<Operator> workspace_operators() {
  return {
      to_workspace("workspace.rig", "Rig", icon::kRig, "Switch to the Rig workspace, to fit a rig into the bones.",
                   Workspace::Rig),
      to_workspace("workspace.skin", "Skin", icon::kSkin,
                   "Switch to the Skin workspace, to paint how tissue follows the bones.", Workspace::Skin),
      to_workspace("workspace.pose", "Pose", icon::kPose,
                   "Switch to the Pose workspace, to turn joints or play a motion.", Workspace::Pose),
      to_workspace("workspace.resample", "Resample", icon::kResample,
                   "Switch to the Resample workspace, to make a new label volume of the posed body.",
                   Workspace::Resample),
      {"workspace.pie", "Workspace menu", "", "Workspace", "Open a menu of the workspaces at the pointer.",
       [](Context& c) { c.menus->open_popup = "Workspaces"; }},
      by_step("workspace.previous", "Previous workspace", -1),
      by_step("workspace.next", "Next workspace", 1),
  };
}

}  // namespace limber::editor
