// SPDX-License-Identifier: AGPL-3.0-or-later
// The built-in poses that fit any body (core/pose/body_poses.h) as entries of the pose library: computed for the open
// rig, with pictures of the rig's skeleton. They are not stored in the document.
#pragma once

#include <string>

#include "core/pose/pose_library.h"

namespace limber::editor {

struct Context;

// Returns the built-in poses for the open rig. They are computed again when the rig changes. The library is empty
// without a rig, or when the names of the rig's bones are not recognised.
const PoseLibrary& body_pose_cards(const Context& context);
// Returns the built-in poses for the open rig with their pictures. The pictures are drawn at the first call.
const PoseLibrary& pictured_body_pose_cards(const Context& context);

// Returns the name by which TransformSettings::library_pose refers to a built-in pose. No pose of the user can have
// this name.
std::string library_name(const NamedPose& body_pose);
bool is_body_pose(const std::string& library_name);

}  // namespace limber::editor
