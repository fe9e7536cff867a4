// SPDX-License-Identifier: AGPL-3.0-or-later
// Moving, turning and scaling joints and bones of the rig at rest, as in Blender's edit mode, in the 3D view and in
// slices. Ends that meet move together. Ctrl snaps: to steps, to voxels, to another joint, or to the middle of the bone
// tissue below.
#pragma once

#include "core/rig/edit_armature.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

struct RigChange {
  enum class Kind { Move, Turn, Scale, Roll } kind = Kind::Move;
  std::string label;          // of the edit
  Armature start;             // the rig, with what the edit has added so far
  std::vector<BoneEnd> ends;  // of `start`; the first is the one that snaps, and what turns and scales go about
  std::vector<int> chosen;    // after it, of `start`
};

std::unique_ptr<TransformTool> begin_rig_change(Editor& editor, const RigChange& change, const Grip& grip = {});

// The axis of the active bone's hinge goes with the pointer, with Ctrl to the nearest of the bone's own axes; digits
// turn it by degrees, about the locked axis or as the picture is seen.
std::unique_ptr<TransformTool> begin_hinge_change(Editor& editor, const Grip& grip = {});

// Of what is chosen: "Move Forearm". A joint alone is moved; turned and scaled are whole bones.
RigChange chosen_change(const Editor& editor, RigChange::Kind kind);
// A bone that grows from the chosen joint.
RigChange extrusion(const Editor& editor);

// The chosen bones, the active one last; and an edit of them by name.
std::vector<int> bones_chosen_last(const Editor& editor);
std::string naming_chosen(const Editor& editor, const std::string& verb);

}  // namespace limber::editor
