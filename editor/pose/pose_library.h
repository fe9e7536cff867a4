// SPDX-License-Identifier: AGPL-3.0-or-later
// The project's library of poses: a card for each with its picture. A click on one applies it to the chosen bones, or
// to all; dragging it sideways goes a part of the way there.
#pragma once

#include "core/pose/pose_library.h"
#include "editor/context/editor.h"
#include "editor/context/operator.h"

namespace limber::editor {

class Column;

const NamedPose* chosen_pose(const Editor& editor);  // nullptr where none is

// The document's pose with the chosen bones `share` of the way to the named one: [0, 1].
Pose on_the_way_to(const Editor& editor, const NamedPose& named, double share);
void apply_pose(Editor& editor, const NamedPose& named, double share);

std::vector<Operator> pose_library_operators();
void draw_pose_library(Editor& editor, Column& column);

}  // namespace limber::editor
