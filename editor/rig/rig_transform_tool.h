// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal tool that moves, turns, scales and rolls joints and bones of the rig in its rest pose, in the 3D view and in
// slices, as Blender's edit mode does. Bone ends at the same position move together. Ctrl snaps to steps, to voxels, to
// another joint, or to the middle of the bone tissue under the pointer.
#pragma once

#include "core/rig/edit_armature.h"
#include "editor/viewport/transform_tool.h"

namespace limber::editor {

struct Context;

struct RigChange {
  enum class Kind { Move, Turn, Scale, Roll } kind = Kind::Move;
  std::string label;          // name of the edit in the undo history
  Armature start;             // the rig before the change, with the bones that the edit adds
  std::vector<BoneEnd> ends;  // bone ends that move; the first end snaps, and is the pivot for turning and scaling
  std::vector<int> chosen;    // bones of `start` that are selected after the edit
};

std::unique_ptr<TransformTool> begin_rig_change(Context& context, const RigChange& change, const Grip& grip = {});

// Begins a tool that points the axis of the active bone's hinge at the pointer; Ctrl snaps it to the nearest of the
// bone's local axes. A typed number turns the axis by that many degrees about the locked axis, or about the line of
// sight when no axis is locked.
std::unique_ptr<TransformTool> begin_hinge_change(Context& context, const Grip& grip = {});

// Returns a change of the selected bones, with a label such as "Move Forearm". If a single joint is selected, a move
// acts on this joint only. The other kinds of change act on whole bones.
RigChange chosen_change(const Context& context, RigChange::Kind kind);
// Returns the change that adds a bone at the selected joint and moves the new bone's tail.
RigChange extrusion(const Context& context);

// Returns the selected bones. The active bone comes last.
std::vector<int> bones_chosen_last(const Context& context);
// Returns an edit's label: the verb, then the selected bone's name or the number of selected bones ("Move 3 bones").
std::string naming_chosen(const Context& context, const std::string& verb);

}  // namespace limber::editor
