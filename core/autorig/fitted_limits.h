// SPDX-License-Identifier: AGPL-3.0-or-later
// Adapts the joint limits of a rig that was fitted to a body with another rest pose. Limits count from rest, but their
// meaning is anatomical: an elbow reaches from straight to 145 degrees, whatever its rest pose. So where the rest pose
// changes, limits change by the difference of the rest angles (core/rig/anatomical_position.h).
#pragma once

#include "core/rig/armature.h"

namespace limber {

// Returns the fitted rig with limits that allow the same anatomical angles as those of `rig`, and always the rest pose.
//   hinge  The range is shifted by the difference of the angles at rest. A hinge that bends one way only and rests bent
//          against its axis gets the opposite axis; an elbow or knee that rests bent across its axis gets an axis at
//          right angles to its bones.
//   ball   The cone reaches as far from the anatomical position as before, and back to that position where it did
//          before. The twist has no anatomical zero and stays.
// Joints whose anatomical position cannot be determined from their bones keep their limits.
//   fitted  the bones of `rig` in the same order at their fitted positions; the axes of limits are rotated along
Armature with_fitted_limits(Armature fitted, const Armature& rig);

}  // namespace limber
