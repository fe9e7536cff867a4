// SPDX-License-Identifier: AGPL-3.0-or-later
// Turning bones and dragging joints, as in Blender. The pointer turns about the line of sight; X, Y or Z locks an axis
// of the chosen space, the same key again another's, once more frees it; R turns like a trackball. Digits are degrees
// or mm. Ctrl snaps, Shift goes slowly. A click or Enter keeps the pose, Escape or the right button brings the old one
// back.
#pragma once

#include "editor/viewport/transform_tool.h"

namespace limber::editor {

// The axes of the rings about a bone's head: those of the space, or turned so that the nearest runs along the hinge of
// a joint that keeps its limits. So a hinge turns by the angle that the pointer goes round its ring.
glm::dmat3 axes_of_rings(const Editor& editor, Space space, const Armature& armature, const Pose& pose, int bone,
                         const ViewProjection& view);
// From a button that is held on a gizmo's ring, the angle goes by the ring as it is seen.
std::unique_ptr<TransformTool> begin_turning(Editor& editor, const Grip& grip = {});
// The tail of the active bone goes with the pointer and its limb follows; a root's head takes the whole body along.
// Pinned tails stay where they are.
std::unique_ptr<TransformTool> begin_dragging(Editor& editor, const Grip& grip = {});

// The chosen bones go the share base + slope * amount of the way from one pose to another. The pointer changes the
// amount, a number is its percentage.
struct Blend {
  std::string label;  // of the edit
  std::string words;  // beside the amount
  Pose from, to;
  double base = 0, slope = 1;
  double begin = 0, most = 1;     // the amount at first, and as far as the pointer takes it
  std::optional<Pose> back = {};  // what amounts below zero lead to, instead of `to`
};
std::unique_ptr<TransformTool> begin_blending(Editor& editor, const Blend& blend);
// The active bone's pole goes with the pointer, and its limb turns towards it.
std::unique_ptr<TransformTool> begin_dragging_pole(Editor& editor, const Grip& grip = {});

}  // namespace limber::editor
