// SPDX-License-Identifier: AGPL-3.0-or-later
// A body of which only a rig is known, for automatic rigging: flesh as round limbs about its bones, as thick as bones
// of their place in a body are for their length. The trunk carries several limbs and is thick, what hangs from it is
// thinner.
#pragma once

#include "core/autorig/body_atlas.h"

namespace limber {

// The atlas has skin and no bones. Throws Error for a rig without length.
BodyAtlas capsule_atlas(const Armature& rig);

// Whether the rig has a trunk that carries limbs at two places or more: an animal's. A chain has none.
bool has_trunk(const Armature& rig);

}  // namespace limber
