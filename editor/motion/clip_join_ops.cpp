// SPDX-License-Identifier: AGPL-3.0-or-later
// The operator that appends a take from a BVH file to the shown clip, with a cross-fade.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/motion/join_poses.h"
#include "core/motion/motion_edit.h"
#include "core/motion/recorded_clip.h"
#include "core/motion/up_axis.h"
#include "core/study/text.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr std::int64_t kMostFrames = 1e6;  // takes are not joined if the joined clip would have more frames
constexpr double kSlides = 10;  // the user is warned if a standing foot slides farther than this in the joined clip, mm

// A take (a recorded motion) that was read from a file and that the user is about to append to the shown clip.
struct NextTake {
  std::shared_ptr<const Motion> motion;
  std::string name;
  UpAxis up = UpAxis::Y;
};

struct JoinWish {
  JoinSettings settings;
  UpAxis up = UpAxis::Y;
  bool is_new = true;
};

std::string needs_clip_and_rig(const Context& context) {
  if (!shown_clip(context.document())) return "Import a motion first, or insert a key";
  return context.document().armature ? "" : "Import a rig first";
}

// Returns true if the take has the clip's frame rate, to within 0.001 frames per second.
bool is_at_rate(const Motion& motion, double rate) { return std::abs(1 / motion.frame_time - rate) <= 1e-3; }

// Returns the number of frames of the take after it is resampled to the clip's frame rate.
std::int64_t frames_at_rate(const Motion& motion, double rate) {
  if (is_at_rate(motion, rate)) return motion.frame_count;
  const double steps = std::floor(std::max(0, motion.frame_count - 1) * motion.frame_time * rate + 1e-6);
  return static_cast<std::int64_t>(std::min(steps, 1e9)) + 1;
}

bool has_joints_of(const Motion& a, const Motion& b) {
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
                    [](const BvhJoint& one, const BvhJoint& other) { return one.name == other.name; });
}

std::vector<Pose> poses_of(const ClipOnRig& clip, int first, int last, Progress& progress) {
  if (!clip.problem().empty()) throw Error("the motions cannot be joined", clip.clip()->name, clip.problem());
  std::vector<Pose> poses;
  for (int frame = first; frame <= last; ++frame) {
    if (progress.cancelled()) throw Cancelled();
    poses.push_back(clip.at(frame));
  }
  return poses;
}

// Returns the poses of the second take, resampled to the frame rate of the first take. If both takes have the same
// joints, the second is retargeted with the settings of the first; otherwise with the settings of a newly imported
// clip.
std::vector<Pose> poses_of_next(const Clip& source, const std::shared_ptr<const Armature>& rig, const NextTake& next,
                                UpAxis up, Progress& progress) {
  Motion motion = up == UpAxis::Z ? y_up_from_z_up(*next.motion) : *next.motion;
  if (!is_at_rate(motion, source.rate)) motion = resampled(motion, source.rate);
  Clip clip = clip_of(std::make_shared<const Motion>(std::move(motion)), next.name);
  if (source.motion && has_joints_of(*source.motion, *clip.motion)) {
    clip.map = source.map;
    clip.retarget.scale = source.retarget.scale;
    clip.retarget.reference = source.retarget.reference;
  }
  clip.retarget.travel = source.motion ? source.retarget.travel : Travel::Free;
  const int last = clip.last;
  return poses_of(ClipOnRig(std::make_shared<const Clip>(std::move(clip)), rig), 0, last, progress);
}

std::string mm_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, mm < 10 ? "%.1f mm" : "%.0f mm", mm);
  return text;
}

struct JoinResult {
  Clip clip;
  std::string line, detail;
  bool is_doubtful = false;
};

JoinResult join(const std::shared_ptr<const Clip>& source, const std::shared_ptr<const Armature>& rig,
                const NextTake& next, const JoinWish& wish, Progress& progress) {
  const int start = source->range_start;
  const std::vector<Pose> first = poses_of(ClipOnRig(source, rig), start, std::max(start, source->range_end), progress),
                          second = poses_of_next(*source, rig, next, wish.up, progress);
  const std::vector<PlantedLimb> limbs = planted_limbs(*rig);
  const JoinedPoses made = joined(*rig, limbs, first, second, source->rate, wish.settings);
  JoinResult result{.clip = clip_of_poses(*source, *rig, made.poses, start)};
  const int seam = start + made.fade_first;
  std::vector<Marker>& markers = result.clip.markers;
  markers.insert(std::upper_bound(markers.begin(), markers.end(), seam,
                                  [](int frame, const Marker& marker) { return frame < marker.frame; }),
                 {seam, next.name});
  result.line = grouped(std::ssize(made.poses)) + " frames: " + next.name + " begins at frame " + std::to_string(seam);
  if (!wish.settings.keeps_feet) return result;
  double slides = 0;
  for (const Plant& plant : made.plants) slides = std::max(slides, error_of(plant, *rig, limbs, made.poses).slide);
  result.detail = made.plants.empty() ? "No standing foot was found in the cross-fade"
                                      : "Standing feet slide in the cross-fade by up to " + mm_text(slides);
  result.is_doubtful = slides > kSlides || made.foot_gap > 0;
  if (made.foot_gap > 0)
    result.detail += "; a foot moves " + mm_text(made.foot_gap) +
                     " without being lifted: join where both motions stand on the same foot";
  return result;
}

void start_joining(Context& context, const NextTake& next, const JoinWish& wish) {
  stop_playing(context);
  const auto source = context.document().clips[static_cast<std::size_t>(context.document().clip)];
  start_task(context, "Join clip", [=, rig = context.document().armature](Progress& progress) -> Finish {
    auto result = std::make_shared<JoinResult>(join(source, rig, next, wish, progress));
    if (wish.is_new) result->clip.name += " + " + next.name;
    return [=](Context& c) {
      take_in_clip(c, source, rig, "Join clip", result->clip, wish.is_new);
      if (result->is_doubtful) c.messages->warn(result->line, result->detail);
      else c.messages->ok(result->line, result->detail);
    };
  });
}

JoinWish wish_of(const std::vector<FormField>& fields) {
  JoinWish wish;
  wish.settings.fade = static_cast<int>(std::lround(fields[0].value));
  wish.settings.keeps_feet = fields[1].chosen == 1;
  wish.up = fields[2].chosen == 1 ? UpAxis::Z : UpAxis::Y;
  wish.is_new = fields[3].chosen == 0;
  return wish;
}

std::string join_outcome(const Context& context, const NextTake& next, const std::vector<FormField>& fields) {
  if (!needs_clip_and_rig(context).empty())
    throw Error("the clip was deleted meanwhile", "join", "select a clip and open the dialog again");
  const auto [low, high] = playing_range(context.document());
  const std::int64_t here = std::int64_t{high} - low + 1,
                     there = frames_at_rate(*next.motion, shown_clip(context.document())->rate);
  const JoinWish wish = wish_of(fields);
  if (wish.settings.fade > std::min(here, there))
    throw Error("the cross-fade is longer than a motion", std::to_string(wish.settings.fade) + " frames",
                "enter 1 to " + std::to_string(std::min(here, there)));
  if (here + there > kMostFrames)
    throw Error("the joined clip has too many frames", grouped(here + there) + " frames", "set a shorter range");
  const auto limbs = planted_limbs(*context.document().armature);
  const bool has_legs = std::any_of(limbs.begin(), limbs.end(), [](const PlantedLimb& limb) { return limb.is_leg; });
  if (wish.settings.keeps_feet && !has_legs)
    throw Error("no leg is recognised in the rig's bone names", "feet", "name the leg bones as in \"LeftThigh\"");
  const bool is_locked =
      shown_clip(context.document())->motion && shown_clip(context.document())->retarget.travel == Travel::Locked;
  return grouped(here) + " frames and " + grouped(there) + " of " + next.name + " become " +
         grouped(here + there - wish.settings.fade) + ", keys included." +
         (is_locked ? " Root motion keeps the body in place. To let it travel, set Root motion to Free first." : "");
}

void ask_join(Context& context, const std::shared_ptr<const NextTake>& next) {
  if (const std::string why = needs_clip_and_rig(context); !why.empty())
    throw Error("the clip was deleted meanwhile", next->name, "import or make a clip first");
  const auto [low, high] = playing_range(context.document());
  const double rate = shown_clip(context.document())->rate;
  const double most = double(std::min(std::int64_t{high} - low + 1, frames_at_rate(*next->motion, rate)));
  const auto limbs = planted_limbs(*context.document().armature);
  const bool has_legs = std::any_of(limbs.begin(), limbs.end(), [](const PlantedLimb& limb) { return limb.is_leg; });
  context.dialogs->open(make_form(
      {"Join " + next->name + ".bvh",
       "Appends this motion to the playing range. It starts with the body's position and heading at the range's end.",
       "Join",
       {number_of("Cross-fade", "Number of frames in which the shown clip fades out and this motion fades in.",
                  std::clamp(std::round(0.3 * rate), 1.0, most), 1, most, "%.0f", "frames"),
        choice_of("Feet", "Keep standing feet in place during the cross-fade.", {"As they are", "Kept in place"},
                  has_legs ? 1 : 0),
        choice_of("Up axis", "The axis that points up in the file.", {"Y", "Z"}, next->up == UpAxis::Z ? 1 : 0),
        choice_of("Result", "Store the joined motion in a new clip, or replace the shown clip.",
                  {"New clip", "Same clip"})},
       [next](const Context& c, const std::vector<FormField>& fields) { return join_outcome(c, *next, fields); },
       [next](Context& c, const std::vector<FormField>& fields) { start_joining(c, *next, wish_of(fields)); }}));
}

void read_next(Context& context, const Path& path) {
  start_task(context, "Read " + path.filename().string(), [path](Progress&) -> Finish {
    auto next = std::make_shared<NextTake>();
    next->motion = std::make_shared<const Motion>(read_bvh(path));
    next->name = path.stem().string();
    if (next->motion->frame_count == 0)
      throw Error("this motion has no frames", path.string(), "select a file with a motion");
    next->up = up_axis_of(*next->motion).axis;
    return [next](Context& c) { ask_join(c, next); };
  });
}

}  // namespace

std::vector<Operator> clip_join_operators() {
  return {
      {"motion.join_clip", "Join clip...", "", "Motion",
       "Append a motion from a BVH file to the clip, with a cross-fade from the body's position and pose at its end.",
       [](Context& context) {
         browse(context, {.purpose = "file.import_motion",
                          .title = "Join a motion to the clip",
                          .action = "Join",
                          .filters = {{"Motions", {".bvh"}}},
                          .folder = context.project->path.parent_path(),
                          .chosen = read_next});
       },
       needs_clip_and_rig}};
}

}  // namespace limber::editor
