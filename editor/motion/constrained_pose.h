// SPDX-License-Identifier: AGPL-3.0-or-later
// Constraints while the rig is posed by hand. The document's pose is the one in which they hold. Below it lies the free
// pose, without them: the one of the clip's motion and keys, with the user's changes. A change of a bone by hand
// changes the free pose, and the constraints then hold again: the trunk is turned, and a planted hand stays. Keys store
// the free pose; otherwise constraints that count only partly would count twice.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/motion/timeline.h"

namespace limber::editor {

// The free poses of the last poses that were made by hand, at a frame of a clip. Undo brings these back.
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
// Returns the document's pose without what constraints have made of it.
Pose unconstrained_pose(Editor& editor);
// Returns the free pose after the user has changed the document's pose to `changed`: bones that constraints have turned
// are turned by as much, the others as they are in `changed`.
//   set  bones whose rotations were set and not turned. They too are as in `changed`; else each repetition would turn
//        them further.
Pose unconstrained_pose(Editor& editor, const Pose& changed, const std::vector<int>& set = {});
// Returns `free` with the constraints of a clip; unchanged if it has none.
Pose constrained_pose(const ClipOnRig& clip, const Pose& free, int frame);
// Returns the pose to show after the user has changed the document's pose to `changed`.
Pose held_by_constraints(Editor& editor, const Pose& changed, const std::vector<int>& set = {});
// Remembers what the free pose of a pose is, at the frame of the document's shown clip.
void remember_free_pose(Editor& editor, const Document& document, const Pose& shown, const Pose& free);
// Returns the free pose below the document's pose, where that was made by hand; nothing where the clip makes it.
std::optional<Pose> free_pose_by_hand(const Editor& editor);
// Changes the shown clip as one edit. The free pose stays as it is, with the user's changes, and the clip's constraints
// hold again.
void change_free_clip(Editor& editor, const std::string& label, const std::function<void(Clip&)>& change);

}  // namespace limber::editor
