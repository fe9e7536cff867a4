// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses from and to our JSON:
//   {"rig": name?, "bones": {name: {"rotation_wxyz": [4]} | {"axis": [3], "degrees": d}}, "root_translation"?: [3]}
// axes in world coordinates at rest, about the bone's head. Bones that are not named stay at rest.
#pragma once

#include "core/base/file.h"
#include "core/rig/pose.h"

namespace limber {

// Throws Error for an unknown bone, a zero axis or quaternion, a number that is not finite.
Pose read_pose(const Path& path, const Armature& armature);
Pose parse_pose(const std::string& text, const std::string& where, const Armature& armature);

// What reads back as the same pose, bit for bit.
void write_pose(const Pose& pose, const Armature& armature, const Path& path);

}  // namespace limber
