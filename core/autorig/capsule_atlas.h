// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes an atlas (body of known shape) for automatic rigging from a rig alone: the flesh is a round limb about each
// bone. The thickness of the limb follows from the bone's length. The trunk, to which several limbs are attached, is
// thick; the limbs are thinner.
#pragma once

#include "core/autorig/body_atlas.h"

namespace limber {

// Returns an atlas made from the rig, with points on the skin but none on bones. Throws Error if all bones of the rig
// have the length 0.
BodyAtlas capsule_atlas(const Armature& rig);

// Returns true if the rig has a trunk with limbs at two or more points, as an animal's rig has. A plain chain of bones
// has no trunk.
bool has_trunk(const Armature& rig);

}  // namespace limber
