// SPDX-License-Identifier: AGPL-3.0-or-later
// Repairs the weights at the active bone's joint in a job (core/repair/repair_joint.h), puts the new weights on a
// weight layer of their own, and shows in the sidebar how much the repair has improved.
#pragma once

#include <string>
#include <vector>

#include "core/project/job.h"
#include "core/repair/repair_joint.h"

namespace limber::editor {

class Column;
struct Context;

// The outcome of the last repair of a joint.
struct RepairedJoint {
  std::string bone;  // name of the bone below the joint
  // What the repair has changed, with ratings of the joint before and after it. The weights in it are empty.
  JointRepair figures;
  // The document's weights right after the repair; if they have changed, the outcome is not shown.
  std::weak_ptr<const SkinWeights> in;
};

// Starts the repair in a job. The document must have weights that belong to its rig, and an active bone with a parent.
// If the repair improves nothing, the document does not change and a message says so.
void start_repairing_joint(Context& context);
bool repairs_joint(const Jobs& jobs);

// Draws the section "Joint" of the sidebar.
void draw_joint_repair(Context& context, Column& column);

}  // namespace limber::editor
