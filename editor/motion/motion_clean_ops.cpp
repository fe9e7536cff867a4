// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that clean the shown clip: filter out jitter, keep feet in place while they stand, hold a hand or foot at a
// position, and replace bad frames. The result is a recorded motion of the playing range; the clip's keys are part of
// this motion.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/motion/clean_motion.h"
#include "core/motion/close_gap.h"
#include "core/motion/pose_filter.h"
#include "core/motion/recorded_clip.h"
#include "core/study/text.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/context/views.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/motion/motion_clip_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

// The user is warned if a limb stays farther than this from the position at which it is held, mm.
constexpr double kOff = 3;
constexpr double kFarthest = 1e6;          // a typed coordinate beyond plus or minus this is an error, mm
constexpr std::int64_t kMostFrames = 1e6;  // a longer playing range is not cleaned

enum class Becomes { NewClip, SameClip };

// Settings that say how the shown clip is cleaned. Frames of `hold` and `gap` are counted from the first frame of the
// playing range.
struct Cleaning {
  std::string label, made;  // label: name of the edit; made: suffix of the new clip's name
  double smooth = 0;        // cutoff frequency of the smoothing filter, Hz; 0: no smoothing
  bool plants_feet = false;
  std::optional<Plant> hold;
  bool stays_where_it_is = false;  // true: the limb is held at the position that it has in the first frame of the hold
  double ease = 0.15;              // time in which a limb moves to the held position and back, s
  struct Gap {
    int first = 0, last = 0;
  };
  std::optional<Gap> gap;  // frames that are replaced by new ones; no value: no frame is replaced
  Becomes becomes = Becomes::NewClip;
};

FormField becomes_field(Becomes usual) {
  return choice_of("Result", "Store the cleaned motion in a new clip, or replace the shown clip.",
                   {"New clip", "Same clip"}, static_cast<int>(usual));
}
FormField ease_field() {
  return number_of("Ease", "Time over which a limb blends into the held position and out of it.", 0.15, 0, 10, "%.2f",
                   "s");
}

std::string needs_clip_and_rig(const Context& context) {
  if (!shown_clip(context.document())) return "Import a motion first, or insert a key";
  return context.document().armature ? "" : "Import a rig first";
}

std::string needs_limb(const Context& context) {
  if (const std::string why = needs_clip_and_rig(context); !why.empty()) return why;
  return planted_limbs(*context.document().armature).empty()
             ? "The rig needs arms or legs with known names, such as LeftForearm"
             : "";
}

std::string frames_text(int first, int last) {
  return "frames " + std::to_string(first) + " to " + std::to_string(last);
}

struct Result {
  std::vector<Pose> poses;
  std::string line, detail;  // the message about the result: its line and its details
  bool is_short = false;     // true: a limb does not reach the position at which it should stay
};

std::string mm_text(double mm) {
  char text[32];
  std::snprintf(text, sizeof text, mm < 10 ? "%.1f mm" : "%.0f mm", mm);
  return text;
}

// The planted limb that is farthest from its position, and that distance in mm.
struct WorstPlant {
  const Plant* plant = nullptr;
  double off = 0;
};
WorstPlant worst_of(const Armature& rig, const std::vector<PlantedLimb>& limbs, const std::vector<Plant>& plants,
                    const std::vector<Pose>& poses) {
  WorstPlant worst;
  for (const Plant& plant : plants)
    if (const double off = error_of(plant, rig, limbs, poses).from_place; !(off <= worst.off) && !std::isnan(worst.off))
      worst = {&plant, off};
  return worst;
}

// If a limb does not reach the position at which it should stay, adds this to the result's message.
//   plants  all limbs that should stay in place
//   told    index of the limb that the result's detail already describes; -1: it describes no limb
void tell_of_short(const Armature& rig, const std::vector<PlantedLimb>& limbs, const std::vector<Plant>& plants,
                   int told, Result& result) {
  const WorstPlant worst = worst_of(rig, limbs, plants, result.poses);
  result.is_short = !(worst.off <= kOff);
  if (!result.is_short) return;
  if (worst.plant->limb == told) result.detail += ": the limb is too short to reach its position";
  else
    result.detail += "; the " + limbs[worst.plant->limb].name + " does not reach its position and is " +
                     mm_text(worst.off) + " away";
}

void tell_of_hold(const Armature& rig, const std::vector<PlantedLimb>& limbs, const Plant& hold, Result& result) {
  const double off = error_of(hold, rig, limbs, result.poses).from_place;
  result.detail = "The " + limbs[hold.limb].name + " is " + mm_text(off) + " away from its position at most";
}

void tell_of_feet(const Armature& rig, const std::vector<PlantedLimb>& limbs, const std::vector<Pose>& before,
                  const std::vector<Plant>& feet, Result& result) {
  double slid = 0, slides = 0;
  for (const Plant& plant : feet) {
    slid = std::max(slid, error_of(plant, rig, limbs, before).slide);
    slides = std::max(slides, error_of(plant, rig, limbs, result.poses).slide);
  }
  if (feet.empty()) {
    result.detail = "No standing foot was found: no foot stays low and slow for 0.1 s";
  } else {
    result.detail = "Feet stand " + std::to_string(feet.size()) + " times; while standing they slid by up to " +
                    mm_text(slid) + ", and now slide by " + mm_text(slides);
  }
}

// Returns the limbs that must stay in place because they rest on something in the recorded poses, such as a hand on a
// rail. Feet are left out if the cleaning plants them anyway, and so is the held limb. Hands that hang freely move
// with the body.
std::vector<Plant> rests_to_keep(const Cleaning& cleaning, const Armature& rig, const std::vector<PlantedLimb>& limbs,
                                 const std::vector<Pose>& recorded, double rate, Progress& progress) {
  std::vector<Plant> rests =
      held_by_world(plants_at_rest(rig, limbs, recorded, rate, progress), rig, limbs, recorded, rate, progress);
  if (cleaning.plants_feet) std::erase_if(rests, [&](const Plant& plant) { return limbs[plant.limb].is_leg; });
  if (cleaning.hold) rests = without_held(rests, *cleaning.hold, static_cast<int>(std::lround(cleaning.ease * rate)));
  return rests;
}

Result clean(const ClipOnRig& clip, int first, int last, Cleaning cleaning, Progress& progress) {
  const Armature& rig = *clip.armature();
  const double rate = clip.clip()->rate;
  std::vector<Pose> recorded;
  for (int frame = first; frame <= last; ++frame) {
    if (progress.cancelled()) throw Cancelled();
    recorded.push_back(clip.at(frame));
  }
  const std::vector<Pose> smooth = cleaning.smooth > 0 ? smoothed(recorded, rate, cleaning.smooth) : recorded;
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  if (cleaning.hold && cleaning.stays_where_it_is)
    cleaning.hold->place =
        place_of(limbs[cleaning.hold->limb], cleaning.hold->point, rig, smooth[cleaning.hold->first]);
  Result result;
  if (cleaning.gap) {
    result.poses = with_gap_closed(smooth, cleaning.gap->first, cleaning.gap->last);
    result.line = std::to_string(cleaning.gap->last - cleaning.gap->first + 1) + " frames replaced";
    result.detail = "The body keeps the speeds that it has before and after these frames";
    return result;
  }
  if (cleaning.plants_feet || cleaning.hold) {
    std::vector<Plant> holds = rests_to_keep(cleaning, rig, limbs, recorded, rate, progress);
    if (cleaning.hold) holds.push_back(*cleaning.hold);
    CleanedMotion cleaned =
        clean_motion(rig, limbs, smooth, rate, cleaning.plants_feet, holds, cleaning.ease, progress);
    result.poses = std::move(cleaned.poses);
    const std::vector<Plant> feet(cleaned.plants.begin(), cleaned.plants.end() - std::ssize(holds));
    if (cleaning.hold) tell_of_hold(rig, limbs, *cleaning.hold, result);
    else tell_of_feet(rig, limbs, recorded, feet, result);
    tell_of_short(rig, limbs, cleaned.plants, cleaning.hold ? cleaning.hold->limb : -1, result);
  } else {
    result.poses = smooth;
  }
  result.line = grouped(std::ssize(result.poses)) + " frames cleaned";
  return result;
}

bool keeps_in_place(const Clip& clip) { return clip.motion && clip.retarget.travel != Travel::Free; }

// Returns true if the cleaning lets the body travel, although the clip's root motion setting keeps the body in place.
// Planting feet needs this: if the body stays in place, each foot slides over the ground, and no standing foot is
// found. Returns false if the clip has constraints or keys of the body's translation, because these rely on the body's
// position.
bool is_let_go(const Clip& clip, const Cleaning& cleaning) {
  return cleaning.plants_feet && keeps_in_place(clip) && clip.keys.root.empty() && !clip.constraints;
}

// Returns the clip whose poses are cleaned: `source`, or a copy in which the body travels (is_let_go()).
std::shared_ptr<const Clip> cleaned_source(const std::shared_ptr<const Clip>& source, const Cleaning& cleaning) {
  if (!is_let_go(*source, cleaning)) return source;
  Clip travels = *source;
  travels.retarget.travel = Travel::Free;
  return std::make_shared<const Clip>(std::move(travels));
}

void take_in(Context& context, const std::shared_ptr<const Clip>& source, int first, const Cleaning& cleaning,
             const std::shared_ptr<const Armature>& rig, const Result& result) {
  const bool is_new = cleaning.becomes == Becomes::NewClip;
  Clip clip = clip_of_poses(*source, *rig, result.poses, first);
  if (is_let_go(*source, cleaning)) clip.retarget.travel = source->retarget.travel;
  if (is_new) clip.name += cleaning.made;
  take_in_clip(context, source, rig, cleaning.label, std::move(clip), is_new);
  if (result.is_short) context.messages->warn(result.line, result.detail);
  else context.messages->ok(result.line, result.detail);
}

// Cleans the playing range of the shown clip in a background task.
void start_cleaning(Context& context, const Cleaning& cleaning) {
  stop_playing(context);
  const auto [first, last] = playing_range(context.document());
  const auto source = context.document().clips[static_cast<std::size_t>(context.document().clip)];
  start_task(context, cleaning.label,
             [source, rig = context.document().armature, cleaning, first, last](Progress& progress) -> Finish {
               const ClipOnRig clip(cleaned_source(source, cleaning), rig);
               if (!clip.problem().empty()) throw Error("the clip cannot be cleaned", source->name, clip.problem());
               const auto result = std::make_shared<const Result>(clean(clip, first, last, cleaning, progress));
               return [=](Context& c) { take_in(c, source, first, cleaning, rig, *result); };
             });
}

bool has_legs(const std::vector<PlantedLimb>& limbs) {
  return std::any_of(limbs.begin(), limbs.end(), [](const PlantedLimb& limb) { return limb.is_leg; });
}

// Throws Error if no clip or rig is left, or if the playing range has too many frames.
void require_frames(const Document& document) {
  if (!shown_clip(document) || !document.armature)
    throw Error("the clip was deleted meanwhile", "clean", "select a clip and open the dialog again");
  const auto [first, last] = playing_range(document);
  if (std::int64_t{last} - first >= kMostFrames)
    throw Error("the playing range has too many frames", frames_text(first, last), "set a shorter range");
}

void ask_cleaning(Context& context) {
  const bool feet = has_legs(planted_limbs(*context.document().armature));
  const double rate = shown_clip(context.document())->rate, most = 0.39 * rate;
  const auto cleaning_of = [](const std::vector<FormField>& fields) {
    Cleaning cleaning{.label = "Clean clip", .made = " clean"};
    cleaning.smooth = fields[0].value;
    cleaning.plants_feet = fields[1].chosen == 1;
    cleaning.ease = fields[2].value;
    cleaning.becomes = static_cast<Becomes>(fields[3].chosen);
    return cleaning;
  };
  context.dialogs->open(make_form(
      {"Clean clip",
       "Removes jitter from the playing range, and keeps standing feet in place.",
       "Clean",
       {number_of("Smooth", "Remove movement above this frequency. 6 Hz suits walking. 0 = no filter.",
                  std::min(6.0, most), 0, most, "%.1f", "Hz"),
        choice_of("Feet", "Keep standing feet and resting hands in place.", {"As they are", "Planted"}, feet ? 1 : 0),
        ease_field(), becomes_field(Becomes::NewClip)},
       [feet, cleaning_of](const Context& c, const std::vector<FormField>& fields) {
         require_frames(c.document());
         const Cleaning cleaning = cleaning_of(fields);
         if (cleaning.smooth <= 0 && !cleaning.plants_feet) throw NotYet{"Set Smooth above 0, or set Feet to Planted."};
         if (cleaning.plants_feet && !feet)
           throw Error("no leg is recognised in the rig's bone names", "feet",
                       "name the leg bones as in \"LeftThigh\"");
         const auto [first, last] = playing_range(c.document());
         return "Cleans " + frames_text(first, last) + ". The clip's keys are baked into the motion." +
                (is_let_go(*shown_clip(c.document()), cleaning)
                     ? " Feet are planted as the body travels; root motion then keeps it in place again."
                 : cleaning.plants_feet && keeps_in_place(*shown_clip(c.document()))
                     ? " Root motion keeps the body in place, so few feet stand: set Root motion to Free first."
                     : "");
       },
       [cleaning_of](Context& c, const std::vector<FormField>& fields) { start_cleaning(c, cleaning_of(fields)); }}));
}

// Reads a position from a text of the form "x, y, z". Throws NotYet if the text has another form, and Error if a
// coordinate is beyond kFarthest.
glm::dvec3 position_in(const std::string& text) {
  glm::dvec3 position(0);
  int end = 0;
  const bool three =
      std::sscanf(text.c_str(), " %lf%*[ ,;]%lf%*[ ,;]%lf %n", &position.x, &position.y, &position.z, &end) == 3;
  const bool finite = std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z);
  if (!three || end != std::ssize(text) || !finite) throw NotYet{"Type the position as x, y, z in mm: 120, -350, 1020"};
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(position[axis]) > kFarthest)
      throw Error("the position is too far away", text, "type at most 1000000 mm for each of x, y and z");
  return position;
}
std::string position_text(const glm::dvec3& position) {
  char text[96];
  std::snprintf(text, sizeof text, "%.1f, %.1f, %.1f", position.x, position.y, position.z);
  return text;
}

// The fields of the form in which the user sets how a limb is held in place, in order.
enum HoldField { kLimb, kFrom, kTo, kPlace, kPosition, kEase, kResult };
enum class HoldPlace { WhereItIs, CrossHair, Position };

glm::dvec3 hold_position(const Views& views, const std::vector<FormField>& fields) {
  return static_cast<HoldPlace>(fields[kPlace].chosen) == HoldPlace::Position ? position_in(fields[kPosition].text)
                                                                              : views.cross_hair;
}

// Returns the position, in the first frame of the hold, of the limb that is selected in the form. Returns nothing if
// the pose of that frame is not known.
std::optional<glm::dvec3> place_before_hold(const Context& context, const std::vector<FormField>& fields) {
  const ClipOnRig* clip = context.timeline->prepared.get();
  if (!clip || clip->clip().get() != shown_clip(context.document()) || !clip->problem().empty()) return {};
  const Armature& rig = *clip->armature();
  const int first = static_cast<int>(fields[kFrom].value);
  return place_of(planted_limbs(rig)[static_cast<std::size_t>(fields[kLimb].chosen)], PlantPoint::Tip, rig,
                  clip->at(first));
}

std::string hold_outcome(const Context& context, const std::vector<FormField>& fields) {
  require_frames(context.document());
  const int first = static_cast<int>(fields[kFrom].value), last = static_cast<int>(fields[kTo].value);
  if (last < first) throw NotYet{"The last frame comes before the first one."};
  const std::string& limb = fields[kLimb].choices[static_cast<std::size_t>(fields[kLimb].chosen)];
  std::string words = "Holds the " + limb + " in " + frames_text(first, last) + ".";
  if (!shown_clip(context.document())->keys.empty()) words += " The clip's keys are baked into the motion.";
  const auto wish = static_cast<HoldPlace>(fields[kPlace].chosen);
  if (wish == HoldPlace::WhereItIs) return words;
  const std::optional<glm::dvec3> place = place_before_hold(context, fields);
  if (wish == HoldPlace::Position && fields[kPosition].text.empty() && place)
    throw NotYet{"Type the position as x, y, z in mm. In frame " + std::to_string(first) + " the " + limb + " is at " +
                 position_text(*place) + "."};
  const glm::dvec3 wanted = hold_position(context.views, fields);
  if (!place) return words;
  return words + " In frame " + std::to_string(first) + " the " + limb + " is " +
         mm_text(glm::distance(*place, wanted)) + " away from this position.";
}

void hold_limb(Context& context, const std::vector<FormField>& fields) {
  const int low = playing_range(context.document()).low;
  Cleaning cleaning{.label = "Hold limb", .made = " held"};
  cleaning.hold = Plant{.limb = fields[kLimb].chosen,
                        .first = static_cast<int>(std::lround(fields[kFrom].value)) - low,
                        .last = static_cast<int>(std::lround(fields[kTo].value)) - low,
                        .place = hold_position(context.views, fields)};
  cleaning.stays_where_it_is = static_cast<HoldPlace>(fields[kPlace].chosen) == HoldPlace::WhereItIs;
  cleaning.ease = fields[kEase].value;
  cleaning.becomes = static_cast<Becomes>(fields[kResult].chosen);
  start_cleaning(context, cleaning);
}

void ask_hold(Context& context) {
  const Armature& rig = *context.document().armature;
  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  std::vector<std::string> names;
  for (const PlantedLimb& limb : limbs) names.push_back(limb.name);
  const auto [low, high] = playing_range(context.document());
  const int frame = std::clamp(shown_frame(context), low, high);
  const int until = std::min(high, frame + static_cast<int>(std::lround(shown_clip(context.document())->rate / 2)));
  context.dialogs->open(make_form(
      {"Hold a hand or foot",
       "Keeps a hand or foot in place for some frames, by bending the elbow or knee.",
       "Hold",
       {choice_of("Limb", "The hand or foot to hold.", names, static_cast<int>(names.size()) - 1),
        number_of("From frame", "The first frame in which the hand or foot is held.", frame, low, high, "%.0f"),
        number_of("To frame", "The last frame in which the hand or foot is held.", until, low, high, "%.0f"),
        choice_of("Hold at",
                  "Where to hold the hand or foot: at its position in the first of these frames, at the cross-hair, or "
                  "at the position typed below.",
                  {"First frame", "Cross-hair", "Position"}),
        text_of("Position", "x, y and z in mm, in LPS axes. Used if Hold at is set to Position.", ""), ease_field(),
        becomes_field(Becomes::SameClip)},
       hold_outcome,
       hold_limb}));
}

std::string needs_gap(const Context& context) {
  if (const std::string why = needs_clip_and_rig(context); !why.empty()) return why;
  const auto [low, high] = playing_range(context.document());
  return high - low < 4 ? "Set a range of at least five frames first" : "";
}

void ask_gap(Context& context) {
  const auto [low, high] = playing_range(context.document());
  const int frame = std::clamp(shown_frame(context), low + 2, high - 2);
  const int until = std::min(high - 2, frame + static_cast<int>(std::lround(shown_clip(context.document())->rate / 4)));
  context.dialogs->open(make_form(
      {"Close gap",
       "Replaces frames, such as those with an error of the motion capture, by a smooth transition.",
       "Replace",
       {number_of("From frame", "The first frame to replace.", frame, low + 2, high - 2, "%.0f"),
        number_of("To frame", "The last frame to replace.", until, low + 2, high - 2, "%.0f"),
        becomes_field(Becomes::SameClip)},
       [](const Context& c, const std::vector<FormField>& fields) {
         require_frames(c.document());
         if (fields[1].value < fields[0].value) throw NotYet{"The last frame comes before the first one."};
         return "Replaces " + frames_text(static_cast<int>(fields[0].value), static_cast<int>(fields[1].value)) +
                ". The clip's keys are baked into the motion.";
       },
       [](Context& c, const std::vector<FormField>& fields) {
         const int first = playing_range(c.document()).low;
         Cleaning cleaning{.label = "Close gap", .made = " closed"};
         cleaning.gap = Cleaning::Gap{static_cast<int>(std::lround(fields[0].value)) - first,
                                      static_cast<int>(std::lround(fields[1].value)) - first};
         cleaning.becomes = static_cast<Becomes>(fields[2].chosen);
         start_cleaning(c, cleaning);
       }}));
}

}  // namespace

std::vector<Operator> motion_clean_operators() {
  return {
      {"motion.clean", "Clean clip...", "", "Motion", "Remove jitter from the clip, and keep standing feet in place.",
       ask_cleaning, needs_clip_and_rig},
      {"motion.hold", "Hold a hand or foot...", "", "Motion",
       "Keep a hand or foot in place for some frames of the clip.", ask_hold, needs_limb},
      {"motion.close_gap", "Close gap...", "", "Motion",
       "Replace frames by a smooth transition that keeps the speed of the motion before and after them.", ask_gap,
       needs_gap},
  };
}

}  // namespace limber::editor
