// SPDX-License-Identifier: AGPL-3.0-or-later
// The project's pose library: a card with a picture for each pose. A click on a card applies the pose to the selected
// bones, or to all bones if none is selected. Dragging a card sideways blends partly towards the pose.
#pragma once

#include "core/pose/pose_library.h"
#include "editor/context/operator.h"

namespace limber::editor {

class Column;
struct Context;

// Returns the selected pose of the library; nullptr if no pose is selected.
const NamedPose* chosen_pose(const Context& context);

// Returns the document's pose with the selected bones blended towards the named pose.
//   share  blend factor, [0, 1]; 1: the named pose
Pose on_the_way_to(const Context& context, const NamedPose& named, double share);
// Returns the bones whose rotations on_the_way_to() sets to a value, for the argument `set` of preview_pose(). If
// `share` is 1, these are the selected bones. If it is smaller, there are none, because the bones are only turned
// towards the named pose.
std::vector<int> set_on_the_way(const Context& context, double share);
void apply_pose(Context& context, const NamedPose& named, double share);

std::vector<Operator> pose_library_operators();
void draw_pose_library(Context& context, Column& column);

}  // namespace limber::editor
