// SPDX-License-Identifier: AGPL-3.0-or-later
// Constraints while the rig is posed by hand. The document's pose fulfils the constraints of the shown clip. It is
// computed from the free pose, which ignores the constraints: the pose of the clip's motion and keys, with the changes
// that the user made by hand. When the user moves a bone, the free pose changes and the constraints are applied again.
// For example, a planted hand stays in place when the user turns the trunk. Keys store the free pose. If they stored
// the constrained pose, constraints with a weight below 1 would be applied twice.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/document.h"

namespace limber::editor {

struct Context;
struct Timeline;

// The poses that the user last made by hand, each with its clip, its frame and its free pose (the pose before
// constraints are applied). When undo restores a pose, its free pose is looked up here.
struct HandPoses {
  struct One {
    std::weak_ptr<const Clip> clip;
    int frame;
    Pose shown, free;
  };
  std::deque<One> poses;
};

// Returns whether the shown clip has constraints that change the poses of motion and keys.
bool is_constrained(const Document& document);
// Returns the document's free pose: the pose before constraints are applied.
Pose unconstrained_pose(Context& context);
// Returns the new free pose after the user has changed the document's pose to `changed`. Each bone of the free pose is
// turned by the rotation between the document's pose and `changed`.
//   set  bones whose rotations the user has set to a value. In the free pose these bones get exactly their rotation in
//        `changed`, because setting the same value again must not turn them further.
Pose unconstrained_pose(Context& context, const Pose& changed, const std::vector<int>& set = {});
// Returns the pose `free` with the clip's constraints applied; `free` itself if the clip has no constraints.
Pose constrained_pose(const ClipOnRig& clip, const Pose& free, int frame);
// Returns the pose to show after the user has changed the document's pose to `changed`. This is the new free pose (the
// pose before constraints are applied), with the constraints applied again.
//   set  bones whose rotations the user has set to a value; the free pose gets exactly these rotations
Pose held_by_constraints(Context& context, const Pose& changed, const std::vector<int>& set = {});
// Stores the free pose `free`, from which applying the constraints gave the pose `shown`, for the document's clip and
// frame.
void remember_free_pose(Timeline& timeline, const Document& document, const Pose& shown, const Pose& free);
// If the user made the document's pose by hand, returns the stored free pose of that pose. Returns nothing if the
// document's pose comes from the clip.
std::optional<Pose> free_pose_by_hand(const Context& context);
// Changes the shown clip as one edit. The free pose (the pose before constraints are applied) stays as it is, so the
// changes that the user made by hand are kept. The document's pose becomes the free pose with the constraints of the
// changed clip applied.
void change_free_clip(Context& context, const std::string& label, const std::function<void(Clip&)>& change);

}  // namespace limber::editor
