// SPDX-License-Identifier: AGPL-3.0-or-later
// Handles of the active bone's joint in the Rig workspace's 3D view, with the rotate tool: the end of a hinge's axis,
// which is drawn to where the hinge shall point, and a knob at the bone's own x axis that rolls the bone.
#pragma once

#include "editor/context/view_projection.h"

namespace limber::editor {

// True when the pointer was over one: its tool has begun.
bool press_joint_handle(Editor& editor, const ViewProjection& view);
void draw_joint_handles(Editor& editor, const ViewProjection& view);

// Where they stand; nothing where there is none. Points of the world.
std::optional<glm::dvec3> hinge_handle(const Editor& editor, const ViewProjection& view);
std::optional<glm::dvec3> roll_handle(const Editor& editor, const ViewProjection& view);

}  // namespace limber::editor
