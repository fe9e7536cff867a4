// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/motion_clip_edits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "core/base/error.h"
#include "core/motion/motion_edit.h"
#include "core/motion/same_skeleton.h"
#include "core/motion/up_axis.h"
#include "core/project/strip_clips.h"
#include "core/study/text.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/motion_clip_preview.h"
#include "editor/motion/timeline.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

// The choices for the length unit of a BVH file, mm. 0: the unit is found by fitting the motion to the rig.
constexpr double kUnits[] = {0, 1, 10, 1000, 25.4};

// A motion that was read from a file, and whose import the user has not confirmed yet.
struct Incoming {
  std::shared_ptr<const Motion> motion;
  std::string name;
  UpGuess up;
  std::string facts, match;
};

std::string facts_of(const Motion& motion) {
  char text[160];
  std::snprintf(text, sizeof text, "%d joints, %s frames, %.2f s at %.5g frames per second.",
                static_cast<int>(motion.joints.size()), grouped(motion.frame_count).c_str(),
                motion.frame_count * motion.frame_time, 1 / motion.frame_time);
  return text;
}

// Returns a text with the most frequent Euler angle order of the motion's joints, and with the joints that have another
// order: "ZXY; differs in 3 joints: Hips XYZ, ..."
std::string orders_of(const Motion& motion) {
  constexpr std::size_t kNamed = 4;
  std::map<std::string, std::vector<std::string>> joints;
  for (const BvhJoint& joint : motion.joints) {
    std::string order;
    for (BvhChannel channel : joint.channels)
      if (channel >= BvhChannel::Xrotation)
        order += static_cast<char>('X' + static_cast<int>(channel) - static_cast<int>(BvhChannel::Xrotation));
    if (!order.empty()) joints[order].push_back(joint.name);
  }
  if (joints.empty()) return "No joint has rotations.";
  const auto most = std::max_element(joints.begin(), joints.end(),
                                     [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  std::string others;
  std::size_t count = 0;
  for (const auto& [order, names] : joints) {
    if (order == most->first) continue;
    for (const std::string& name : names)
      if (count++ < kNamed) others += (others.empty() ? "" : ", ") + name + " " + order;
  }
  if (count == 0) return most->first + " in every joint, as stored in the file.";
  return most->first + "; differs in " + std::to_string(count) + (count == 1 ? " joint: " : " joints: ") + others +
         (count > kNamed ? ", ..." : ".");
}

std::string match_of(std::shared_ptr<const Motion> motion, const std::shared_ptr<const Armature>& armature) {
  if (!armature) return "There is no rig yet: joints and bones are matched when a rig is imported.";
  const ClipOnRig on_rig(std::make_shared<const Clip>(clip_of(std::move(motion), "")), armature);
  if (!on_rig.retarget()) return "No joint's name matches a bone of this rig: match them by hand with Map...";
  const Matching matching = matching_of(on_rig);
  char text[160];
  std::snprintf(text, sizeof text, "%d joints move %d of %d bones; %d of these matches are certain.", matching.joints,
                matching.bones, static_cast<int>(armature->bones.size()), matching.sure);
  return text;
}

void take_in(Context& context, const Incoming& incoming, const std::vector<FormField>& fields) {
  std::shared_ptr<const Motion> motion = incoming.motion;
  const bool z_up = fields[1].chosen == 1;
  if (z_up) motion = std::make_shared<const Motion>(y_up_from_z_up(*motion));
  Document next = context.document();
  Clip clip = clip_for(next, motion, incoming.name, static_cast<int>(std::round(fields[2].value)));
  clip.rate = fields[3].value;
  clip.retarget.scale = kUnits[fields[0].chosen];
  add_clip(next, std::move(clip));
  commit(context, "Import " + incoming.name + ".bvh", std::move(next));
  if (z_up) context.messages->info(incoming.name + ".bvh is turned upright", "The z axis points up in the file.");
}

void ask(Context& context, const std::shared_ptr<const Incoming>& incoming) {
  const double rate = clip_of(incoming->motion, "").rate;
  const auto outcome = [incoming](const Context&, const std::vector<FormField>& fields) {
    std::string words = incoming->facts + " " + incoming->match;
    const bool as_guessed = fields[1].chosen == static_cast<int>(incoming->up.axis);
    if (const std::string reason = reason_of(incoming->up);
        !reason.empty() && (!as_guessed || incoming->up.axis == UpAxis::Z))
      words += (as_guessed ? " Z is up: " : " Check the up axis: ") + reason + ".";
    if (std::abs(fields[3].value - clip_of(incoming->motion, "").rate) > 1e-3) {
      char text[64];
      std::snprintf(text, sizeof text, " The motion lasts %.2f s.", incoming->motion->frame_count / fields[3].value);
      words += text;
    }
    for (const std::string& warning : incoming->motion->warnings) words += "\n" + warning;
    return words;
  };
  auto picture = std::make_shared<MotionPicture>(incoming->motion);
  const auto draw_picture = [picture](Context& c, const Rect& rect, const std::vector<FormField>& fields) {
    picture->draw(c, rect, fields[1].chosen == 1, fields[3].value);
  };
  context.dialogs->open(make_form(
      {"Import " + incoming->name + ".bvh",
       "Adds this motion as a new clip and retargets it to the rig.",
       "Import",
       {choice_of("Scale",
                  "Scale of the motion's distances: fitted to the rig's legs, or given by the unit of the file.",
                  {"Fit to the rig", "1 = 1 mm", "1 = 1 cm", "1 = 1 m", "1 = 1 inch"}),
        choice_of("Up axis", "The axis that points up in the file.", {"Y", "Z"}, static_cast<int>(incoming->up.axis)),
        number_of("First frame", "Frame of the timeline at which the clip begins.", 0, -100'000, 100'000, "%.0f"),
        number_of("Frame rate", "Frames per second, as stored in the file. Change this only if the file is wrong.",
                  rate, 1, 1000, "%.6g", "fps"),
        fact_of("Rotations", orders_of(*incoming->motion))},
       outcome,
       [incoming](Context& c, const std::vector<FormField>& fields) { take_in(c, *incoming, fields); },
       draw_picture}));
}

}  // namespace

Matching matching_of(const ClipOnRig& clip) {
  Matching matching;
  const Retarget* retarget = clip.retarget();
  if (!retarget) return matching;
  std::set<int> joints;
  for (int bone = 0; bone < std::ssize(clip.armature()->bones); ++bone)
    if (const int joint = retarget->joint_of(bone); joint >= 0) joints.insert(joint);
  matching.bones = moved_bones(clip);
  matching.joints = static_cast<int>(joints.size());
  for (MatchKind kind : match_kinds(*clip.clip()->motion, *clip.armature(), map_in_use(clip)))
    matching.sure += kind >= MatchKind::SamePart;
  return matching;
}

int moved_bones(const ClipOnRig& clip) {
  int moved = 0;
  for (int bone = 0; clip.retarget() && bone < std::ssize(clip.armature()->bones); ++bone)
    moved += clip.retarget()->joint_of(bone) >= 0;
  return moved;
}

RetargetMap map_in_use(const ClipOnRig& clip) {
  RetargetMap map{.stances = clip.clip()->map.stances};
  if (!clip.retarget()) return map;
  for (int bone = 0; bone < std::ssize(clip.armature()->bones); ++bone)
    if (const int joint = clip.retarget()->joint_of(bone); joint >= 0) {
      const std::string& name = clip.armature()->bones[bone].name;
      const auto given = clip.clip()->map.sources.find(name);
      map.sources[name] = given != clip.clip()->map.sources.end()
                              ? given->second
                              : RetargetMap::Source{clip.clip()->motion->joints[joint].name, {}};
    }
  return map;
}

Clip clip_for(const Document& document, std::shared_ptr<const Motion> motion, const std::string& name, int start) {
  const auto same = document.armature ? same_skeleton(*motion, *document.armature) : std::nullopt;
  Clip clip = clip_of(std::move(motion), name, start);
  if (same && same->in_place) clip.retarget.travel = Travel::Free;
  return clip;
}

void take_in_clip(Context& context, const std::shared_ptr<const Clip>& source,
                  const std::shared_ptr<const Armature>& rig, const std::string& label, Clip clip, bool is_new,
                  std::optional<double> frame, double ratio) {
  settle_frame(context);
  Document next = context.document();
  const auto place = std::find(next.clips.begin(), next.clips.end(), source);
  if (place == next.clips.end() || next.armature != rig)
    throw Error("the clip or the rig was changed meanwhile", source->name, "run the command again: " + label);
  const double last = std::max(clip.range_start, clip.range_end);
  next.frame = static_cast<int>(std::clamp(frame.value_or(next.frame), double(clip.range_start), last));
  if (is_new) {
    add_clip(next, std::move(clip));
  } else {
    next.clip = static_cast<int>(place - next.clips.begin());
    const auto changed = std::make_shared<const Clip>(std::move(clip));
    next.clips[static_cast<std::size_t>(next.clip)] = changed;
    if (ratio != 1) follow_frames(next, source, changed, ratio);
  }
  next.pose = pose_at_frame(next, &context.timeline->prepared);
  context.timeline->chosen.clear();
  commit(context, label, std::move(next));
}

void choose_clip(Context& context, int clip) {
  if (clip == context.document().clip) return;
  stop_playing(context);
  Document next = context.document();
  next.clip = clip;
  next.frame = std::clamp(next.frame, next.shown_clip()->range_start,
                          std::max(next.shown_clip()->range_start, next.shown_clip()->range_end));
  next.pose = pose_at_frame(next, &context.timeline->prepared);
  context.timeline->chosen.clear();
  const std::string label = "Show clip " + next.shown_clip()->name;
  commit(context, label, std::move(next));
}

void import_motion(Context& context, const Path& path) {
  start_task(context, "Read " + path.filename().string(),
             [path, armature = context.document().armature](Progress&) -> Finish {
               auto incoming = std::make_shared<Incoming>();
               incoming->motion = std::make_shared<const Motion>(read_bvh(path));
               incoming->name = path.stem().string();
               if (incoming->motion->frame_count == 0)
                 throw Error("this motion has no frames", path.string(), "import it as a rig, or select another file");
               incoming->up = up_axis_of(*incoming->motion);
               incoming->facts = facts_of(*incoming->motion);
               incoming->match = match_of(incoming->motion, armature);
               return [incoming](Context& c) { ask(c, incoming); };
             });
}

}  // namespace limber::editor
