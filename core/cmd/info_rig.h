// SPDX-License-Identifier: AGPL-3.0-or-later
// Describes rigs, motions, poses and models for the command `info`, as JSON text:
//   rig     {"kind": "rig", "format", "bones": [{"name", "parent": name | null, "head": [3], "tail": [3], "roll"?,
//            "limits"?}]}
//   motion  {"kind": "motion", "format", "joints": [{"name", "parent", "offset": [3], "channels": [names],
//            "end_site"?}], "channels", "frames", "frame_time"}; a BVH without frames is a rig
//   pose    {"kind": "pose", "bones": [names]}
//   model   {"kind": "rig" with bones, else "mesh", "format", counts of its elements}
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber::cmd {

// Returns true for .bvh .vtk .arm .gltf .glb .obj, and for a .json that contains a rig or a pose.
bool is_rig_or_motion(const Path& file);

// Returns the file's description as JSON text. Warnings go to stderr. Throws Error for a file that cannot be read.
std::string describe_rig_or_motion(const Path& file);

}  // namespace limber::cmd
