// SPDX-License-Identifier: AGPL-3.0-or-later
// Repairs the joint of the active bone in a job (core/repair/repair_joint.h), puts the new weights on a weight layer of
// its own, and shows in the sidebar what the repair has gained.
#pragma once

#include <string>
#include <vector>

#include "core/repair/repair_joint.h"
#include "editor/context/editor.h"

namespace limber::editor {

class Column;

// The outcome of the last repair.
struct RepairedJoint {
  std::string bone;                     // name of the bone below the joint
  JointRepair figures;                  // without its weights
  std::weak_ptr<const SkinWeights> in;  // the document's weights right after the repair; with others it tells nothing
};

// Starts the job. The document must have weights that belong to its rig, and an active bone with a parent. Without a
// gain, the document does not change and a message says so.
void start_repairing_joint(Editor& editor);
bool repairs_joint(const Editor& editor);

// Draws the section "Joint" of the sidebar.
void draw_joint_repair(Editor& editor, Column& column);

}  // namespace limber::editor
