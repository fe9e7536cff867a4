// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that change the whole shown clip: mirror it, change its speed, repeat it as a loop, and turn its keys into
// a recorded motion.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "core/base/error.h"
#include "core/motion/clip_speed.h"
#include "core/motion/loop_poses.h"
#include "core/motion/mirror_clip.h"
#include "core/motion/recorded_clip.h"
#include "core/motion/strip_edits.h"
#include "core/study/text.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr std::int64_t kMostFrames = 1e6;  // a command that would record or repeat more frames fails with an error
// The speed of a clip with fewer frames than this is changed at once, that of a longer clip in a background task.
constexpr double kFewFrames = 2000;
// Where the end of a loop is blended into its start, bones can turn faster than in the recorded motion. If they turn
// faster by more than this factor, the user is warned.
constexpr double kHasty = 1.5;

std::string needs_clip(const Context& context) {
  return shown_clip(context.document()) ? "" : "Import a motion first, or insert a key";
}
std::string needs_clip_and_rig(const Context& context) {
  if (const std::string why = needs_clip(context); !why.empty()) return why;
  return context.document().armature ? "" : "Import a rig first";
}
std::string needs_three_frames(const Context& context) {
  if (const std::string why = needs_clip_and_rig(context); !why.empty()) return why;
  const auto [low, high] = playing_range(context.document());
  return high - low < 2 ? "Set a range of at least three frames first" : "";
}

std::shared_ptr<const Clip> shared_clip(const Document& document) {
  return document.clips[static_cast<std::size_t>(document.clip)];
}

std::string frames_text(int frames) { return grouped(frames) + (frames == 1 ? " frame" : " frames"); }

// Throws Error if no clip or rig is left, or if the playing range has too many frames.
void require_frames(const Context& context) {
  if (!needs_clip_and_rig(context).empty())
    throw Error("the clip was deleted meanwhile", "clip", "select a clip and open the dialog again");
  const auto [first, last] = playing_range(context.document());
  if (std::int64_t{last} - first >= kMostFrames)
    throw Error("the playing range has too many frames",
                "frames " + std::to_string(first) + " to " + std::to_string(last), "set a shorter range");
}

void mirror_shown(Context& context) {
  stop_playing(context);
  const auto source = shared_clip(context.document());
  edit_clip(context, "Mirror clip", PoseThen::FromClip,
            [&](Clip& clip) { clip = mirrored_clip(source, context.document().armature); });
}

void bake(Context& context) {
  stop_playing(context);
  require_frames(context);
  const auto source = shared_clip(context.document());
  start_task(context, "Bake clip", [source, rig = context.document().armature](Progress& progress) -> Finish {
    const auto baked = std::make_shared<const Clip>(baked_clip(source, rig, progress));
    return [=](Context& c) {
      take_in_clip(c, source, rig, "Bake clip", *baked, false);
      c.messages->ok(frames_text(baked->motion->frame_count) + " baked",
                     "The motion now contains the keys and the retargeting, for this rig's bones");
    };
  });
}

// ---- Change the speed of a clip

const Clip& require_clip(const Document& document) {
  const Clip* clip = shown_clip(document);
  if (!clip) throw Error("the clip was deleted meanwhile", "speed", "select a clip and open the dialog again");
  return *clip;
}

// Returns the speed factor from the form's fields: the given speed, or the speed at which the playing range gets the
// given length.
double factor_of(const Clip& clip, const std::vector<FormField>& fields) {
  if (fields[0].chosen == 0) return fields[1].value;
  const int steps = clip.range_end - clip.range_start, wanted = static_cast<int>(std::lround(fields[2].value)) - 1;
  if (steps < 1)
    throw Error("the clip plays a single frame", "the length of the clip",
                "set the speed instead, or set a longer range");
  return double(steps) / wanted;
}

std::string speed_outcome(const Context& context, const std::vector<FormField>& fields) {
  const Clip* clip = &require_clip(context.document());
  const double factor = factor_of(*clip, fields);
  if (factor == 1) throw NotYet{"The clip has this speed already."};
  const double steps = double(clip->range_end) - clip->range_start;
  if (factor < kSlowest || factor > kFastest)
    throw Error("this length cannot be reached", frames_text(static_cast<int>(fields[2].value)),
                "enter a length from " + std::to_string(static_cast<int>(std::ceil(steps / kFastest)) + 1) + " to " +
                    std::to_string(static_cast<std::int64_t>(steps / kSlowest) + 1));
  if (clip->strips)  // throws Error if a strip's speed would leave its range
    rescaled_strips(
        *clip->strips, [](int frame) { return frame; }, 1, factor);
  std::set<int> moved;
  const std::set<int> keys = frames_of(clip->keys);
  for (const int frame : keys) moved.insert(static_cast<int>(std::lround((frame - clip->start) / factor)));
  char text[160];
  std::snprintf(text, sizeof text, "%s at %.4g times the speed become %s.",
                frames_text(clip->range_end - clip->range_start + 1).c_str(), factor,
                frames_text(static_cast<int>(std::lround(steps / factor)) + 1).c_str());
  return text + (moved.size() < keys.size() ? " " + std::to_string(keys.size() - moved.size()) +
                                                  " frames with keys coincide with others and are deleted."
                                            : std::string());
}

// Replaces the shown clip by the clip with the changed speed. The play head moves to the frame that shows the same
// moment of the motion.
void take_in_speed(Context& context, const std::shared_ptr<const Clip>& source,
                   const std::shared_ptr<const Armature>& rig, const Clip& changed, double factor) {
  settle_frame(context);
  std::optional<double> moment;
  if (context.document().shown_clip() == source.get())
    moment = changed.start + std::round((double(context.document().frame) - changed.start) / factor);
  take_in_clip(context, source, rig, "Change speed", changed, false, moment, 1 / factor);
}

// Changes the speed of a short clip at once, so that the user can adjust the speed afterwards. Changes a long clip in
// a background task, which the user can cancel.
void change_speed(Context& context, double factor) {
  const auto source = shared_clip(context.document());
  const auto rig = context.document().armature;
  const std::int64_t recorded = source->motion ? source->motion->frame_count : 0;
  const double steps = std::max<double>(double(recorded), double(source->range_end) - source->range_start);
  if (std::max(steps, steps / factor) < kFewFrames)
    return take_in_speed(context, source, rig, at_speed(*source, factor), factor);
  start_task(context, "Change speed", [=](Progress& progress) -> Finish {
    const auto changed = std::make_shared<const Clip>(at_speed(*source, factor, progress));
    return [=](Context& c) { take_in_speed(c, source, rig, *changed, factor); };
  });
}

void ask_speed(Context& context) {
  stop_playing(context);
  const auto [low, high] = playing_range(context.document());
  context.dialogs->open(make_form(
      {"Change speed",
       "Makes the clip longer or shorter at the same frame rate. Keys, markers and range are stretched with it.",
       "Change",
       {choice_of("Change by", "Set the clip's speed, or its length.", {"Speed", "Length"}),
        number_of("Speed", "2 plays twice as fast, 0.5 half as fast.", 1, kSlowest, kFastest, "%.3f", "times"),
        number_of("Length", "Number of frames in the playing range afterwards.",
                  std::clamp<double>(double(high) - low + 1, 2, 1e6), 2, 1e6, "%.0f", "frames")},
       speed_outcome,
       [](Context& c, const std::vector<FormField>& fields) {
         stop_playing(c);
         change_speed(c, factor_of(require_clip(c.document()), fields));
       }}));
}

// ---- Repeat a clip as a loop

void tell_of_loop(Messages& messages, const LoopedPoses& loop, int repeats) {
  char text[160];
  std::snprintf(text, sizeof text, "Where repeats meet, poses differ by up to %.1f\u00b0%s%.40s", loop.gap_degrees,
                loop.gap_bone.empty() ? "" : ", in ", loop.gap_bone.c_str());
  const std::string detail = text;
  const std::string line = std::to_string(repeats) + (repeats == 1 ? " repeat, " : " repeats, ") +
                           frames_text(static_cast<int>(loop.poses.size()));
  if (loop.haste <= kHasty) return messages.ok(line, detail);
  std::snprintf(text, sizeof text,
                "; blending them turns bones %.1f times as fast: loop a whole cycle, or blend over more frames",
                loop.haste);
  messages.warn(line, detail + text);
}

void start_looping(Context& context, const LoopSettings& settings, bool is_new) {
  stop_playing(context);
  const auto [first, last] = playing_range(context.document());
  const auto source = shared_clip(context.document());
  start_task(context, "Loop clip", [=, rig = context.document().armature](Progress& progress) -> Finish {
    const ClipOnRig clip(source, rig);
    if (!clip.problem().empty()) throw Error("the clip cannot be repeated", source->name, clip.problem());
    std::vector<Pose> poses;
    for (int frame = first; frame <= last; ++frame) {
      if (progress.cancelled()) throw Cancelled();
      poses.push_back(clip.at(frame));
    }
    const auto loop = std::make_shared<const LoopedPoses>(looped(*rig, poses, settings));
    auto made = std::make_shared<Clip>(clip_of_poses(*source, *rig, loop->poses, first));
    if (is_new) made->name += " loop";
    return [=](Context& c) {
      take_in_clip(c, source, rig, "Loop clip", *made, is_new);
      tell_of_loop(c.messages, *loop, settings.repeats);
    };
  });
}

LoopSettings loop_of(const std::vector<FormField>& fields) {
  return {.repeats = static_cast<int>(std::lround(fields[0].value)),
          .blend = static_cast<int>(std::lround(fields[1].value)),
          .stays = fields[2].chosen == 1};
}

void ask_loop(Context& context) {
  const auto [low, high] = playing_range(context.document());
  const int steps = high - low;
  const double usual = std::min<double>(steps, std::round(0.3 * shown_clip(context.document())->rate));
  context.dialogs->open(make_form(
      {"Loop clip",
       "Repeats the playing range. Each repeat begins where the one before ended, in the pose of the first frame.",
       "Loop",
       {number_of("Repeats", "How many times the playing range plays in total.", 4, 1, 1000, "%.0f"),
        number_of("Blend",
                  "Number of frames in which the end of each repeat is blended into the beginning of the next.", usual,
                  0, steps, "%.0f", "frames"),
        choice_of("Body", "Let each repeat continue from the body's position and heading, or keep the body in place.",
                  {"Travels", "In place"}),
        choice_of("Result", "Store the repeats in a new clip, or replace the shown clip.", {"New clip", "Same clip"})},
       [](const Context& c, const std::vector<FormField>& fields) {
         require_frames(c);
         const auto [first, last] = playing_range(c.document());
         const LoopSettings settings = loop_of(fields);
         const std::int64_t frames = std::int64_t{last - first} * settings.repeats + 1;
         if (frames > kMostFrames)
           throw Error("these repeats have too many frames", grouped(frames) + " frames", "enter fewer repeats");
         const bool is_locked =
             shown_clip(c.document())->motion && shown_clip(c.document())->retarget.travel == Travel::Locked;
         return frames_text(last - first + 1) + " become " + frames_text(static_cast<int>(frames)) +
                ", keys included." +
                (is_locked && !settings.stays
                     ? " Root motion keeps the body in place. To let it travel, set Root motion to Free first."
                     : "");
       },
       [](Context& c, const std::vector<FormField>& fields) {
         start_looping(c, loop_of(fields), fields[3].chosen == 0);
       }}));
}

}  // namespace

std::vector<Operator> clip_deed_operators() {
  return {
      {"motion.mirror_clip", "Mirror clip", icon::kMirror, "Motion",
       "Swap left and right in the whole clip: its motion, its keys with their curves, and the body's path.",
       mirror_shown, needs_clip_and_rig},
      {"motion.loop_clip", "Loop clip...", icon::kLoop, "Motion",
       "Repeat the playing range, and blend each repeat into the next. The body can travel or stay in place.", ask_loop,
       needs_three_frames},
      {"motion.speed", "Change speed...", "", "Motion",
       "Make the clip longer or shorter by a factor or to a number of frames. Keys are stretched with it.", ask_speed,
       needs_clip},
      {"motion.bake", "Bake clip", "", "Motion",
       "Bake keys and curves into the motion of the playing range. The animation does not change.", bake,
       needs_clip_and_rig},
  };
}

}  // namespace limber::editor
