// SPDX-License-Identifier: AGPL-3.0-or-later
// The anatomical roles of a rig's bones, found by their names (joint_names.h).
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

using BoneRoles = std::vector<std::optional<JointRole>>;  // one for each bone of the rig

// Returns the role of each bone; nothing for a bone whose name is not recognized.
BoneRoles bone_roles(const Armature& armature);
// Returns the role of each bone; a bone whose name is not recognized gets its parent's role.
BoneRoles inherited_bone_roles(const Armature& armature);

}  // namespace limber
