// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose that the user works on. This is the document's pose, except while a tool changes the pose: then it is the
// changed pose, which the views show before the tool commits it.
#pragma once

#include <vector>

#include "core/project/document.h"

namespace limber::editor {

struct Context;

// pose_of() returns the document's pose, or the rest pose if the document has no pose. shown_pose() returns the pose
// that the views show. Both need a document with a rig.
Pose pose_of(const Document& document);
Pose shown_pose(const Context& context);

// Makes the views show this pose in place of the document's pose, until drop_shown_pose() is called.
void show_pose(Context& context, Pose pose);
void drop_shown_pose(Context& context);

// chosen_bones() returns the selected bones, or all bones if none is selected. topmost() leaves out every bone that has
// an ancestor in `bones`, and returns the others.
std::vector<int> chosen_bones(const Context& context);
std::vector<int> topmost(const Armature& armature, const std::vector<int>& bones);

}  // namespace limber::editor
