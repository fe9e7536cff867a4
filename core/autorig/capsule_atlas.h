// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes an atlas for automatic rigging from a rig alone: the flesh is a round limb about each bone. Its thickness
// follows from the bone's length: the trunk, which carries several limbs, is thick, and the limbs are thinner.
#pragma once

#include "core/autorig/body_atlas.h"

namespace limber {

// Returns an atlas with skin and without bones. Throws Error for a rig without length.
BodyAtlas capsule_atlas(const Armature& rig);

// Returns whether the rig has a trunk that carries limbs at two points or more, as an animal's does; a chain has none.
bool has_trunk(const Armature& rig);

}  // namespace limber
