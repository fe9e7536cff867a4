// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes an atlas (body of known shape) for automatic rigging from a rig alone: the flesh is a round limb about each
// bone. Its thickness follows from the bone's length: the trunk, which carries several limbs, is thick, and the limbs
// are thinner.
#pragma once

#include "core/autorig/body_atlas.h"

namespace limber {

// Returns an atlas made from the rig, with points on the skin but none on bones. Throws Error for a rig all of whose
// bones have no length.
BodyAtlas capsule_atlas(const Armature& rig);

// Returns true if the rig has a trunk (as an animal's rig has) that carries limbs at two points or more. A plain chain
// of bones has no trunk.
bool has_trunk(const Armature& rig);

}  // namespace limber
