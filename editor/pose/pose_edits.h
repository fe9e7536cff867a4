// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose that is worked on: the document's, or what is shown in its place while a tool changes it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "editor/context/transform_settings.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

// The pose in which the last frame shows the bones, and the body where it follows them. Handles and marks stand by it.
Pose seen_pose(const Editor& editor);

// So many bones from this one up to where the rig branches: an arm does not take the trunk along.
int limb_of(const Armature& armature, int bone);

// With X-mirror on, the other sides of the bones that were turned do the same in the mirror.
Pose mirrored_too(const Editor& editor, const Pose& before, Pose next);

// What a change of a pose may do at a joint's limits.
Pose limited(const Editor& editor, Pose pose, const std::vector<int>& bones);

// One edit; none where nothing changed.
void commit_pose(Editor& editor, const std::string& label, Pose pose);
//   next  the document with what else the edit changes
void commit_pose(Editor& editor, const std::string& label, Pose pose, Document next);

// The document's pins and poles, maybe none.
const Anchors& anchors_of(const Document& document);

// A rotation relative to rest as turns about the bone's own axes, x first, then y, then z: degrees.
glm::dvec3 own_angles(const Bone& bone, const glm::dquat& rotation);
glm::dquat turned_by_own_angles(const Bone& bone, const glm::dvec3& degrees);

}  // namespace limber::editor
