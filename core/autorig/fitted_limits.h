// SPDX-License-Identifier: AGPL-3.0-or-later
// Joint limits of a rig that was fitted to a body which rests in another pose. Limits count from rest, but what they
// mean is anatomical: an elbow reaches from straight to 145 degrees, however it rests. Where rest changes, limits
// change by the difference of the rest angles (core/rig/anatomical_position.h).
#pragma once

#include "core/rig/armature.h"

namespace limber {

// The fitted rig with limits that allow the same anatomical angles as those of `rig`; rest stays allowed.
//   hinge  its range is shifted by the difference of the angles at rest. A hinge that only bends one way and rests bent
//          against its axis gets the opposite axis; an elbow or knee that rests bent across its axis gets one across
//          its bones.
//   ball   its cone reaches as far from the anatomical position as before, and back to that position where it did
//          before; its twist has no anatomical zero and stays.
// Joints of which the bones do not tell the anatomical position keep their limits.
//   fitted  the bones of `rig` in the same order, elsewhere; axes of limits turned along
Armature with_fitted_limits(Armature fitted, const Armature& rig);

}  // namespace limber
