// SPDX-License-Identifier: AGPL-3.0-or-later
// Two handles at the active bone in the 3D view of the Rig workspace, shown while the rotate tool is active. One turns
// the axis of the bone's hinge joint. The other lies on the bone's local x axis and rolls the bone.
#pragma once

#include <optional>

#include <glm/glm.hpp>

namespace limber::editor {

struct Context;
struct ViewProjection;

// Begins to drag the handle under the pointer. Returns false when there is no handle under the pointer.
bool press_joint_handle(Context& context, const ViewProjection& view);
void draw_joint_handles(Context& context, const ViewProjection& view);

// Return the position of the hinge handle and of the roll handle, world coordinates in mm; nothing when the handle is
// not shown in this view.
std::optional<glm::dvec3> hinge_handle(const Context& context, const ViewProjection& view);
std::optional<glm::dvec3> roll_handle(const Context& context, const ViewProjection& view);

}  // namespace limber::editor
