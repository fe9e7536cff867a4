// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the document's pose, with X-mirror and joint limits applied. Also returns the document's pins and poles:
// pins keep the ends of limbs in place during inverse kinematics, and limbs bend towards their poles.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/project/document.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

struct Context;

// Returns the pose in which the last drawn frame shows the bones. It may be older than the edited pose while the body's
// preview is computed. Gizmos and marks are drawn at this pose.
Pose seen_pose(const Context& context);

// Returns the number of bones of the limb whose last bone is `bone`. The limb's first bone is the child of the nearest
// ancestor that has more than one child, so that an arm does not include the trunk.
int limb_of(const Armature& armature, int bone);

// With X-mirror on, returns `next` with each rotation that differs from `before` also applied, as a mirror image, to
// the bone's counterpart on the other side of the body. With X-mirror off, returns `next` unchanged.
Pose mirrored_too(const Context& context, const Pose& before, Pose next);

// Returns the pose with the rotations of `bones` restricted to their joint limits; unchanged while "Keep to joint
// limits" is off.
Pose limited(const Context& context, Pose pose, const std::vector<int>& bones);

// Shows the changed pose without an edit, with the clip's constraints applied.
//   set  bones whose rotations the user has set to a value, for example by typing an angle. All other changed bones
//        were turned relative to their old rotation. Constraints treat these two cases differently
//        (editor/motion/constrained_pose.h).
void preview_pose(Context& context, const Pose& pose, const std::vector<int>& set = {});
// Commits the pose as one edit; does nothing when the document does not change.
void commit_pose(Context& context, const std::string& label, Pose pose, const std::vector<int>& set = {});
// Commits the pose together with the document `next`, which may contain other changes, as one edit.
void commit_pose(Context& context, const std::string& label, Pose pose, Document next,
                 const std::vector<int>& set = {});
// Returns the indices of the bones whose rotations differ between the two poses.
std::vector<int> changed_bones(const Pose& before, const Pose& after);

// Returns the document's pins and poles; empty when the document has none.
const Anchors& anchors_of(const Document& document);

// Convert between a bone's rotation relative to rest and angles in degrees about the bone's local axes: first x, then
// y, then z.
glm::dvec3 own_angles(const Bone& bone, const glm::dquat& rotation);
glm::dquat turned_by_own_angles(const Bone& bone, const glm::dvec3& degrees);

}  // namespace limber::editor
