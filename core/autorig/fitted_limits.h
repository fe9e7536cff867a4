// SPDX-License-Identifier: AGPL-3.0-or-later
// Adapts the joint limits of a rig that was fitted to a body with another rest pose. Limit angles are measured from the
// rest pose, but their meaning is anatomical: an elbow bends from straight to 145 degrees, whatever its rest pose. So
// the limits change by the difference between the old and the new angle at rest (core/rig/anatomical_position.h).
#pragma once

#include "core/rig/armature.h"

namespace limber {

// Returns the fitted rig with limits that allow the same anatomical angles as those of `rig`, and always the rest pose.
//   hinge  The range is shifted by the difference between the angles at rest. If a hinge bends one way only and rests
//          bent against its axis, its axis is reversed. If an elbow or knee rests bent across its axis, its axis
//          becomes perpendicular to its bones.
//   ball   The cone (limit of the swing away from rest) is changed so that the bone still reaches the same smallest and
//          largest angles to the anatomical position. The twist limits stay, since twist has no anatomical zero.
// Joints whose anatomical position cannot be determined from their bones keep their limits.
//   fitted  the bones of `rig` in the same order at their fitted positions; the axes of limits are already rotated with
//           the bones
Armature with_fitted_limits(Armature fitted, const Armature& rig);

}  // namespace limber
