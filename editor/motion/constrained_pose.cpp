// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/constrained_pose.h"

#include <algorithm>

#include "core/motion/constraint_stack.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/motion/timeline.h"
#include "editor/shown/shown_pose.h"

namespace limber::editor {

namespace {

constexpr std::size_t kMostPoses = 512;

}  // namespace

bool is_constrained(const Document& document) {
  return document.armature && document.shown_clip() && document.shown_clip()->constraints;
}

std::optional<Pose> free_pose_by_hand(const Context& context) {
  const Document& document = context.document();
  const auto& by_hand = context.timeline->by_hand;
  if (!by_hand || !is_constrained(document)) return std::nullopt;
  const auto& clip = document.clips[static_cast<std::size_t>(document.clip)];
  const Pose pose = pose_of(document);
  for (const HandPoses::One& one : by_hand->poses)
    if (one.clip.lock() == clip && one.frame == document.frame && one.shown == pose) return one.free;
  return std::nullopt;
}

Pose unconstrained_pose(Context& context) {
  Pose pose = pose_of(context.document());
  const ClipOnRig* clip = clip_on_rig(context);
  if (!clip || !clip->constraints()) return pose;
  if (auto free = free_pose_by_hand(context)) return *free;
  const int frame = context.document().frame;
  const Pose made = clip->at(frame), free = clip->unconstrained_at(frame);
  for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone)
    if (pose.rotation[bone] == made.rotation[bone]) pose.rotation[bone] = free.rotation[bone];
  return pose;
}

Pose unconstrained_pose(Context& context, const Pose& changed, const std::vector<int>& set) {
  if (!is_constrained(context.document())) return changed;
  const Pose before = pose_of(context.document());
  Pose free = unconstrained_pose(context);
  free.root_translation = changed.root_translation;
  const auto is_set = [&](std::size_t bone) { return std::find(set.begin(), set.end(), bone) != set.end(); };
  for (std::size_t bone = 0; bone < free.rotation.size(); ++bone) {
    const glm::dquat &was = before.rotation[bone], &is = changed.rotation[bone];
    if (is == was) continue;
    free.rotation[bone] = is_set(bone) || free.rotation[bone] == was
                              ? is
                              : glm::normalize(is * glm::conjugate(was) * free.rotation[bone]);
  }
  return free;
}

Pose constrained_pose(const ClipOnRig& clip, const Pose& free, int frame) {
  return clip.constraints() ? clip.constraints()->constrained(free, clip.clip()->keys, frame) : free;
}

Pose held_by_constraints(Context& context, const Pose& changed, const std::vector<int>& set) {
  if (!is_constrained(context.document())) return changed;
  const Pose free = unconstrained_pose(context, changed, set);
  return constrained_pose(*clip_on_rig(context), free, context.document().frame);
}

void remember_free_pose(Timeline& timeline, const Document& document, const Pose& shown, const Pose& free) {
  auto& by_hand = timeline.by_hand;
  if (!by_hand) by_hand = std::make_shared<HandPoses>();
  by_hand->poses.push_front({document.clips[static_cast<std::size_t>(document.clip)], document.frame, shown, free});
  if (by_hand->poses.size() > kMostPoses) by_hand->poses.pop_back();
}

void change_free_clip(Context& context, const std::string& label, const std::function<void(Clip&)>& change) {
  stop_playing(context);
  settle_frame(context);
  Document next = context.document();
  const Pose free = unconstrained_pose(context), rest = rest_pose(*next.armature);
  // If the clip has no keys, no constraints and no motion that can be retargeted, the user has made the whole pose by
  // hand. Keys are inserted for this pose, because the changed clip would otherwise replace it.
  const ClipOnRig* before = clip_on_rig(context);
  const bool is_bare = !before || (!before->has_base() && before->clip()->keys.empty() && !before->clip()->constraints);
  if (is_bare && free != rest) key_changes(next, rest, free);
  if (next.clips.empty()) next.clips.push_back(std::make_shared<const Clip>(Clip{.name = "Keys"}));
  auto& shown = next.clips[static_cast<std::size_t>(next.clip)];
  Clip clip = *shown;
  change(clip);
  if (clip.constraints && clip.constraints->list.empty()) clip.constraints = nullptr;
  shown = std::make_shared<const Clip>(std::move(clip));
  const Pose held = constrained_pose(ClipOnRig(shown, next.armature, clip_on_rig(context)), free, next.frame);
  next.pose = held == rest ? nullptr : std::make_shared<const Pose>(held);
  remember_free_pose(context.timeline, next, held, free);
  drop_shown_pose(context);
  if (next != context.document()) commit(context, label, std::move(next));
}

}  // namespace limber::editor
