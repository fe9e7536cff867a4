// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose that is worked on: the document's, or what is shown in its place while a tool changes it.
#pragma once

#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

// At rest where the document has none. Needs a rig.
Pose pose_of(const Document& document);
Pose shown_pose(const Editor& editor);

// Shows a pose until it is committed or dropped.
void show_pose(Editor& editor, Pose pose);
void drop_shown_pose(Editor& editor);

// The chosen bones that hang on no other chosen one, all bones where none is chosen.
std::vector<int> chosen_bones(const Editor& editor);
std::vector<int> topmost(const Armature& armature, const std::vector<int>& bones);

}  // namespace limber::editor
