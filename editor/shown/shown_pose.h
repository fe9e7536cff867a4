// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose that the user works on: the document's pose, or, while a tool changes it, the changed pose that the views
// show.
#pragma once

#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

// pose_of() returns the document's pose, or the rest pose if it has none. shown_pose() returns the pose that the views
// show. The document must have a rig.
Pose pose_of(const Document& document);
Pose shown_pose(const Editor& editor);

// Makes the views show this pose in place of the document's pose, until drop_shown_pose() is called.
void show_pose(Editor& editor, Pose pose);
void drop_shown_pose(Editor& editor);

// chosen_bones() returns the selected bones, or all bones if none is selected. topmost() returns those of `bones` that
// have no ancestor in `bones`.
std::vector<int> chosen_bones(const Editor& editor);
std::vector<int> topmost(const Armature& armature, const std::vector<int>& bones);

}  // namespace limber::editor
