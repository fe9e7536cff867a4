// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/pose_inbetween_ops.h"

#include <algorithm>

#include "core/motion/constraint.h"
#include "core/pose/apply_pose_as_rest.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/workspace.h"
#include "editor/motion/constrained_pose.h"
#include "editor/motion/timeline.h"
#include "editor/pose/pose_edits.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

// Returns the frames at which the selected bones have keys. When no bone is selected, returns the frames of all keys.
std::set<int> key_frames(const Context& context) {
  std::set<int> frames;
  const Clip* clip = shown_clip(context.document());
  if (!clip || !context.document().armature) return frames;
  const auto add = [&](const auto& keys) {
    for (const auto& [frame, value] : keys) frames.insert(frame);
  };
  for (const int bone : chosen_bones(context)) {
    const Bone& b = context.document().armature->bones[bone];
    if (const auto keys = clip->keys.bones.find(b.name); keys != clip->keys.bones.end()) add(keys->second);
    if (b.parent < 0) add(clip->keys.root);
  }
  return frames;
}

std::string needs_other_key(const Context& context) {
  if (context.workspace() != Workspace::Pose) return "Switch to the Pose workspace first";
  std::set<int> frames = key_frames(context);
  frames.erase(shown_frame(context));
  return frames.empty() ? "The selected bones have no key at another frame: insert a key first" : "";
}

std::string needs_next_key(const Context& context) {
  if (context.workspace() != Workspace::Pose) return "Switch to the Pose workspace first";
  const std::set<int> frames = key_frames(context);
  return frames.upper_bound(shown_frame(context)) == frames.end()
             ? "The selected bones have no later key: insert a key first"
             : "";
}

void blend_to_neighbours(Context& context) {
  settle_frame(context);
  const int now = context.document().frame;
  const std::set<int> frames = key_frames(context);
  const ClipOnRig* clip = clip_on_rig(context);
  const auto next = frames.upper_bound(now), here = frames.lower_bound(now);
  const Pose pose = pose_of(context.document());
  PoseBlend blend{.label = "Blend to neighbour",
                  .words = "to the key before or after",
                  .from = pose,
                  .to = next == frames.end() ? pose : clip->at(*next),
                  .back = here == frames.begin() ? pose : clip->at(*std::prev(here))};
  begin_tool(context, begin_blending(context, blend));
}

// Changes the next key of each selected bone so that it holds the bone's rotation in the shown pose.
void propagate(Context& context) {
  settle_frame(context);
  const int now = context.document().frame;
  const std::shared_ptr<const Armature> armature = context.document().armature;
  const Pose pose = unconstrained_pose(context);
  const std::vector<int> bones = chosen_bones(context);
  edit_clip(context, "Propagate pose", PoseThen::Stays, [&](Clip& clip) {
    for (const int bone : bones) {
      const Bone& b = armature->bones[bone];
      if (const auto keys = clip.keys.bones.find(b.name); keys != clip.keys.bones.end())
        if (const auto next = keys->second.upper_bound(now); next != keys->second.end())
          next->second = pose.rotation[bone];
      if (const auto next = clip.keys.root.upper_bound(now); b.parent < 0 && next != clip.keys.root.end())
        next->second = pose.root_translation;
    }
  });
}

std::string needs_change(const Context& context) {
  if (context.workspace() != Workspace::Pose) return "Switch to the Pose workspace first";
  return context.document().armature && context.document().pose ? "" : "The rig is at rest: pose a bone first";
}

// Makes the pose the rest pose of the rig. The volume does not move, so a rig can be fitted to a body by posing it.
void apply_as_rest(Context& context) {
  settle_frame(context);
  drop_shown_pose(context);
  Document next = context.document();
  for (auto& part : next.clips) {
    if (!part->constraints) continue;
    Clip clip = *part;
    Constraints constraints = *clip.constraints;
    for (Constraint& constraint : constraints.list)
      constraint = with_pose_as_rest(constraint, *next.armature, pose_of(next));
    clip.constraints = std::make_shared<const Constraints>(std::move(constraints));
    part = std::make_shared<const Clip>(std::move(clip));
  }
  next.armature = std::make_shared<const Armature>(with_pose_as_rest(*next.armature, pose_of(next)));
  next.pose = nullptr;
  const bool weights = next.weights != nullptr;
  const bool poses = !next.poses.empty() || std::any_of(next.clips.begin(), next.clips.end(), [](const auto& clip) {
    return !clip->keys.bones.empty() || clip->constraints;
  });
  commit(context, "Apply pose as rest", std::move(next));
  if (weights)
    context.messages->info("Apply pose as rest", "The weights belong to the old rest pose: compute them again");
  if (poses)
    context.messages->warn("Apply pose as rest",
                           "Keys, constraints and library poses now start from the new rest pose: check them");
}

}  // namespace

std::optional<PoseBlend> between_keys(Context& context) {
  settle_frame(context);
  const int now = context.document().frame;
  const std::set<int> frames = key_frames(context);
  const auto next = frames.upper_bound(now), here = frames.lower_bound(now);
  if (next == frames.end() || here == frames.begin()) return std::nullopt;
  const int before = *std::prev(here);
  const ClipOnRig* clip = clip_on_rig(context);
  return PoseBlend{.label = "Breakdown",
                   .words = "from frame " + std::to_string(before) + " to " + std::to_string(*next),
                   .from = clip->at(before),
                   .to = clip->at(*next),
                   .begin = 0.5};
}

std::vector<Operator> pose_neighbour_operators() {
  return {
      {"pose.blend_neighbour", "Blend to neighbour", "", "Pose",
       "Blend the selected bones towards the next or the previous key, with the pointer or by percent.",
       blend_to_neighbours, needs_other_key},
      {"pose.propagate", "Propagate pose", "", "Pose", "Copy the pose of the selected bones to their next key.",
       propagate, needs_next_key},
      {"pose.apply_as_rest", "Apply pose as rest", icon::kRig, "Pose",
       "Make the current pose the rest pose of the rig. The volume does not move.", apply_as_rest, needs_change},
  };
}

}  // namespace limber::editor
