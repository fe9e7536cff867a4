// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes poses as JSON:
//   {"rig": name?, "bones": {name: {"rotation_wxyz": [4]} | {"axis": [3], "degrees": d}}, "root_translation"?: [3]}
// Axes are in world coordinates at rest, and bones rotate about their heads. Bones that are not listed stay at rest.
// Instead of "bones", or on top of them, a file may give clinical angles in degrees from the anatomical position
// (joint_angles.h), which fit any rig whose bones are known by their names:
//   {"angles": {"left hip": {"flexion": 90, "abduction": 5}, "knees": {"flexion": 90}}}
#pragma once

#include "core/base/file.h"
#include "core/rig/pose.h"

namespace limber {

// Read a pose from a file or from text; `where` names the text in messages. Both functions throw Error for an unknown
// bone, joint or motion, a joint that the rig does not have, a zero axis or quaternion, or a number that is not finite.
Pose read_pose(const Path& path, const Armature& armature);
Pose parse_pose(const std::string& text, const std::string& where, const Armature& armature);

// Writes a file that reads back as the same pose, bit for bit.
void write_pose(const Pose& pose, const Armature& armature, const Path& path);

}  // namespace limber
