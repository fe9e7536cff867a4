// SPDX-License-Identifier: AGPL-3.0-or-later
// The poses that any body can take (core/pose/body_poses.h) as entries of the pose library, for the open rig, with
// pictures of its skeleton in them. They are no part of the document.
#pragma once

#include <string>

#include "core/pose/pose_library.h"
#include "editor/context/editor.h"

namespace limber::editor {

// Found once for each rig, and again when it changes. Empty without a rig or where its bones are not known by their
// names.
const PoseLibrary& body_pose_cards(const Editor& editor);
// The same with pictures, which are drawn the first time.
const PoseLibrary& pictured_body_pose_cards(const Editor& editor);

// What TransformSettings::library_pose calls such a pose: no name that a user gives.
std::string library_name(const NamedPose& body_pose);
bool is_body_pose(const std::string& library_name);

}  // namespace limber::editor
