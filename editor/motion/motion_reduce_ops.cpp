// SPDX-License-Identifier: AGPL-3.0-or-later
// The operator that replaces the poses of the playing range by a few keys, so that the user can edit a recorded motion
// by its curves.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/motion/reduce_planted.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr std::int64_t kMostFrames = 100'000;  // a longer playing range is not reduced to keys

std::string needs_clip_and_rig(const Context& context) {
  if (!shown_clip(context.document())) return "Import a motion first, or insert a key";
  return context.document().armature ? "" : "Import a rig first";
}

struct Wanted {
  ReduceSettings settings;
  // Planted feet and hands may differ by at most this from their positions in the motion, mm; 0: not limited.
  double plant_mm = 0;
  bool is_new = true;
};

struct Reduced {
  PlantedKeys keys;
  std::size_t plants = 0;  // number of times that a foot stands or a hand rests in place
  double plant_mm = 0;     // the error in the position of these feet and hands that the user allowed, mm

  bool is_short() const { return plants > 0 && !(keys.most_off <= plant_mm); }
};

std::string summary_of(const Reduced& result) {
  const ReducedKeys& reduced = result.keys.reduced;
  char text[160];
  std::snprintf(text, sizeof text, "Largest error %.2g\u00b0%s%.60s", reduced.most_degrees,
                reduced.worst_bone.empty() ? "" : ", in ", reduced.worst_bone.c_str());
  std::string words = text;
  if (!reduced.keys.root.empty()) {
    std::snprintf(text, sizeof text, "; the body at most %.2g mm from its path", reduced.most_mm);
    words += text;
  }
  if (result.plants > 0) {
    std::snprintf(text, sizeof text, "; standing feet and resting hands at most %.2g mm from their recorded positions",
                  result.keys.most_off);
    words += text;
    if (result.is_short()) {
      std::snprintf(text, sizeof text, ", more than the %.2g mm that you allow", result.plant_mm);
      words += text;
    }
  }
  return words;
}

// Returns a clip with the reduced keys and no recorded motion.
Clip keyed_clip(const Clip& source, const ReducedKeys& reduced, int first, int last, const std::string& name) {
  Clip clip{.name = name, .rate = source.rate, .start = first, .range_start = first, .range_end = last};
  clip.keys = reduced.keys;
  clip.markers = source.markers;
  return clip;
}

void take_in(Context& context, const std::shared_ptr<const Clip>& source, const std::shared_ptr<const Armature>& rig,
             const FrameRange& range, bool is_new, const Reduced& result) {
  const ReducedKeys& reduced = result.keys.reduced;
  take_in_clip(context, source, rig, "Reduce to keys",
               keyed_clip(*source, reduced, range.low, range.high, is_new ? source->name + " keys" : source->name),
               is_new);
  const std::string line = std::to_string(range.high - range.low + 1) + " frames became " +
                           std::to_string(reduced.count) + " keys of " + std::to_string(reduced.keys.bones.size()) +
                           (reduced.keys.bones.size() == 1 ? " bone" : " bones");
  if (result.is_short()) context.messages->warn(line, summary_of(result));
  else context.messages->ok(line, summary_of(result));
}

Reduced reduce(const Armature& rig, const std::vector<Pose>& poses, double rate, int start, const Wanted& wanted,
               Progress& progress) {
  if (wanted.plant_mm <= 0) return {{reduced_to_keys(rig, poses, start, wanted.settings, progress)}};
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  const std::vector<Plant> plants = resting_limbs(rig, limbs, poses, rate, progress);
  return {reduced_with_plants(rig, limbs, poses, start, wanted.settings, plants, wanted.plant_mm, progress),
          plants.size(), wanted.plant_mm};
}

void start_reducing(Context& context, const Wanted& wanted) {
  stop_playing(context);
  const FrameRange range = playing_range(context.document());
  const auto source = context.document().clips[static_cast<std::size_t>(context.document().clip)];
  start_task(context, "Reduce to keys", [=, rig = context.document().armature](Progress& progress) -> Finish {
    const ClipOnRig clip(source, rig);
    if (!clip.problem().empty()) throw Error("the clip cannot be reduced", source->name, clip.problem());
    std::vector<Pose> poses;
    for (int frame = range.low; frame <= range.high; ++frame) {
      if (progress.cancelled()) throw Cancelled();
      poses.push_back(clip.at(frame));
    }
    const auto reduced =
        std::make_shared<const Reduced>(reduce(*rig, poses, source->rate, range.low, wanted, progress));
    return [=](Context& c) { take_in(c, source, rig, range, wanted.is_new, *reduced); };
  });
}

std::string outcome_of(const Context& c) {
  if (!shown_clip(c.document()) || !c.document().armature)
    throw Error("the clip was deleted meanwhile", "reduce", "select a clip and open the dialog again");
  const auto [first, last] = playing_range(c.document());
  if (std::int64_t{last} - first >= kMostFrames)
    throw Error("the playing range has too many frames",
                "frames " + std::to_string(first) + " to " + std::to_string(last), "set a shorter range");
  return "Reduces frames " + std::to_string(first) + " to " + std::to_string(last) +
         ", with the clip's keys. The result has keys and no recorded motion.";
}

void ask_reducing(Context& context) {
  const bool has_limbs = !planted_limbs(*context.document().armature).empty();
  context.dialogs->open(make_form(
      {"Reduce to keys",
       "Replaces the playing range by a few keys with Bezier curves, for editing in the graph editor.",
       "Reduce",
       {number_of("Rotation error", "Largest difference of a bone's rotation from the recording, in any frame.", 0.5,
                  0.01, 45, "%.2f", "\u00b0"),
        number_of("Position error", "Largest distance of the body from its recorded position, in any frame.", 2, 0.01,
                  1000, "%.2f", "mm"),
        number_of("Planted feet",
                  "Largest distance of standing feet and resting hands from their recorded positions. A smaller "
                  "distance needs more keys. 0 = no limit: feet may slide.",
                  has_limbs ? 1 : 0, 0, has_limbs ? 1000 : 0, "%.2f", "mm"),
        choice_of("Result", "Store the keys in a new clip, or replace the shown clip.", {"New clip", "Same clip"})},
       [](const Context& c, const std::vector<FormField>&) { return outcome_of(c); },
       [](Context& c, const std::vector<FormField>& fields) {
         start_reducing(c,
                        {{.degrees = fields[0].value, .mm = fields[1].value}, fields[2].value, fields[3].chosen == 0});
       }}));
}

}  // namespace

std::vector<Operator> motion_reduce_operators() {
  return {
      {"motion.reduce_keys", "Reduce to keys...", "", "Motion",
       "Replace the playing range by a few keys with curves that stay within an error that you set.", ask_reducing,
       needs_clip_and_rig},
  };
}

}  // namespace limber::editor
