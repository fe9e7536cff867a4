// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal tools that turn bones, drag joints and blend poses, as in Blender. Moving the pointer turns bones about the
// line of sight. Pressing X, Y or Z locks an axis of the selected space; pressing it again locks that axis of another
// space; a third press unlocks. R turns bones like a trackball. Typed numbers are degrees, mm or percent. Ctrl snaps,
// Shift slows down. A click or Enter keeps the new pose; Escape or the right button restores the old one.
#pragma once

#include "editor/context/transform_settings.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

struct Context;
struct PoseEditing;
struct ViewProjection;

// Returns the axes of the gizmo's three rings at a bone's head, as columns: the axes of the coordinate space `space`.
// If the bone's joint is a hinge and joint limits are kept, the axes are rotated so that the axis nearest to the
// hinge's axis coincides with it. Dragging this ring by an angle then turns the hinge by the same angle.
glm::dmat3 axes_of_rings(const PoseEditing& posing, Space space, const Armature& armature, const Pose& pose, int bone,
                         const ViewProjection& view);
// Begins to turn the selected bones. If the user drags a ring of the gizmo, the angle is measured in the plane of the
// ring.
std::unique_ptr<TransformTool> begin_turning(Context& context, const Grip& grip = {});
// Begins to drag the tail of the active bone while the bones of its limb follow. Dragging the root bone moves the whole
// body. Pinned tails keep their positions.
std::unique_ptr<TransformTool> begin_dragging(Context& context, const Grip& grip = {});

// A blend of the selected bones between two poses. At share 0 the bones have the pose `from`, at share 1 the pose `to`.
// The share is base + slope * amount. The pointer changes the amount; a typed number is the amount in percent.
struct PoseBlend {
  std::string label;  // name of the edit in the undo history
  std::string words;  // text shown below the amount
  Pose from, to;
  double base = 0, slope = 1;
  double begin = 0, most = 1;  // initial amount; largest amount that the pointer can set
  // The pose towards which negative amounts blend; no value: the amount cannot be negative.
  std::optional<Pose> back = {};
};
std::unique_ptr<TransformTool> begin_blending(Context& context, const PoseBlend& blend);
// Begins to drag the pole of the active bone's limb. The limb's middle joint turns towards the pole.
std::unique_ptr<TransformTool> begin_dragging_pole(Context& context, const Grip& grip = {});

}  // namespace limber::editor
