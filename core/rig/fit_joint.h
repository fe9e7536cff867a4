// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits the axis of a joint to the bones around it. A rig's joint is rarely the anatomical one: turning about it drives
// bone into bone. The axis (its direction and its place) is moved as little as possible so that the two sides' bone
// parts do not overlap anywhere in a range of angles.
#pragma once

#include "core/rig/bone_parts.h"

namespace limber {

struct FitJoint {
  double minimum_degrees = 0, maximum_degrees = 90;  // range of the flex that must stay free of collision
};

struct FittedJoint {
  Armature armature;             // head moved (and the parent's tail, where it met it), hinge stored in limits
  double moved_mm = 0;           // of the head, across the axis
  double turned_degrees = 0;     // of the axis
  std::int64_t overlap_before = 0, overlap_after = 0;  // largest number of colliding bone voxels over the range
};

// throws Error when the bone has no flex axis or one side has no bone tissue
FittedJoint fit_joint(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, int bone, const FitJoint& settings = {},
                      Progress& progress = no_progress());

}  // namespace limber
