// SPDX-License-Identifier: AGPL-3.0-or-later
// limber clean-motion RIG --motion F.bvh [--smooth HZ] [--plant-feet] [--hold "LIMB[=X,Y,Z]@FIRST-LAST"]... [--mirror]
// [--speed F] [--loop N [--seam FRAMES] [--on-the-spot]] -o OUT.bvh: cleans a motion on a rig. Removes jitter and foot
// sliding and holds hands at given positions; then mirrors the motion, changes its speed and repeats it.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/pose_options.h"
#include "core/motion/bvh.h"
#include "core/motion/clean_motion.h"
#include "core/motion/clip_speed.h"
#include "core/motion/loop_poses.h"
#include "core/motion/motion_edit.h"
#include "core/motion/pose_filter.h"
#include "core/rig/mirror.h"
#include "core/rig_io/rig_io.h"

namespace limber::cmd {

namespace {
struct CleanMotionOptions {
  std::string rig, output;
  PoseOptions motion;
  double smooth = 0, ease = 0.15;
  bool plant_feet = false;
  std::vector<std::string> holds;
  bool mirror = false, on_the_spot = false;
  double speed = 1;
  // Number of repeats (0: not repeated), and number of frames over which two repeats are blended where they meet, the
  // seam (-1: as many as in 0.3 seconds).
  int repeats = 0, seam = -1;

  bool cleans() const { return smooth > 0 || plant_feet || !holds.empty(); }
};

constexpr const char* kHoldForm =
    "write it as \"left hand=X,Y,Z@FIRST-LAST\", or \"left hand@FIRST-LAST\" to hold it at its position in frame FIRST";

std::vector<double> numbers_in(std::string_view text, char between, const std::string& where) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(between, from), text.size());
    const auto number = number_of<double>(text.substr(from, to - from));
    if (!number || !std::isfinite(*number)) throw Error("the value of --hold is not valid", where, kHoldForm);
    numbers.push_back(*number);
    from = to + 1;
  }
  return numbers;
}

// Reads a value of the option --hold. The limb's tip is the point that is held.
Plant hold_of(const std::string& value, const std::vector<PlantedLimb>& limbs, const Armature& rig,
              const std::vector<Pose>& poses) {
  const std::string where = "--hold \"" + value + "\"";
  const std::size_t at = value.rfind('@'), equals = value.find('=');
  if (at == std::string::npos) throw Error("the value of --hold is not valid", where, kHoldForm);
  const std::string name = value.substr(0, std::min(at, equals));
  Plant hold;
  const auto found = std::find_if(limbs.begin(), limbs.end(), [&](const PlantedLimb& l) { return l.name == name; });
  if (found == limbs.end()) {
    std::string names;
    for (const PlantedLimb& limb : limbs) names += (names.empty() ? "" : ", ") + limb.name;
    throw Error("the rig has no limb of this name", where, "name one of: " + names);
  }
  hold.limb = static_cast<int>(found - limbs.begin());
  const std::vector<double> frames = numbers_in(std::string_view(value).substr(at + 1), '-', where);
  const double last = static_cast<double>(poses.size()) - 1;
  if (frames.size() != 2 || frames[0] != std::floor(frames[0]) || frames[1] != std::floor(frames[1]))
    throw Error("the value of --hold is not valid", where, kHoldForm);
  if (frames[0] < 0 || frames[1] < frames[0] || frames[1] > last)
    throw Error("the motion does not have these frames", where,
                "choose frames from 0 to " + std::to_string(static_cast<int>(last)));
  hold.first = static_cast<int>(frames[0]);
  hold.last = static_cast<int>(frames[1]);
  if (equals > at) {
    hold.place = place_of(*found, hold.point, rig, poses[hold.first]);
    return hold;
  }
  const std::vector<double> place = numbers_in(std::string_view(value).substr(equals + 1, at - equals - 1), ',', where);
  if (place.size() != 3) throw Error("the value of --hold is not valid", where, kHoldForm);
  hold.place = {place[0], place[1], place[2]};
  constexpr double kFarthest = 1e6;  // larger coordinates are refused, mm
  for (const double one : place)
    if (std::abs(one) > kFarthest)
      throw Error("the position is more than 1 km from the origin", where,
                  "write it in millimetres, in the world coordinates of the rig");
  return hold;
}

void print_plants(const std::vector<Plant>& plants, const Armature& rig, const std::vector<PlantedLimb>& limbs,
                  const std::vector<Pose>& before, const std::vector<Pose>& after) {
  if (plants.empty()) return;
  print("%-12s %-6s %12s %14s %14s %14s\n", "limb", "point", "frames", "slide before", "slide after", "off target");
  for (const Plant& plant : plants) {
    const PlantError was = error_of(plant, rig, limbs, before), is = error_of(plant, rig, limbs, after);
    const std::string frames = std::to_string(plant.first) + "-" + std::to_string(plant.last);
    print("%-12s %-6s %12s %11.1f mm %11.1f mm %11.1f mm\n", limbs[plant.limb].name.c_str(),
          plant.point == PlantPoint::Tip ? "tip" : "joint", frames.c_str(), was.slide, is.slide, is.from_place);
  }
}

// Prints a warning for each plant (a position at which a limb must stay) that the limb does not reach.
void warn_of_short_limbs(const std::vector<Plant>& plants, const Armature& rig, const std::vector<PlantedLimb>& limbs,
                         const std::vector<Pose>& poses) {
  constexpr double kOff = 3;  // mm; smaller distances from the position cause no warning
  for (const Plant& plant : plants)
    if (const PlantError error = error_of(plant, rig, limbs, poses); error.from_place > kOff)
      warn(limbs[plant.limb].name + ", frames " + std::to_string(plant.first) + " to " + std::to_string(plant.last) +
           ": the limb stays " + std::to_string(std::lround(error.from_place)) + " mm away from its position");
}

// Mirrors the poses, changes their speed and repeats them, as the options say.
std::vector<Pose> changed(const CleanMotionOptions& options, const Armature& rig, double rate,
                          std::vector<Pose> poses) {
  if (options.mirror)
    for (Pose& pose : poses) pose = flipped(pose, rig);
  if (options.speed != 1) poses = at_speed(poses, options.speed);
  if (options.repeats == 0) return poses;
  const double usual = std::min(std::round(0.3 * rate), double(poses.size()) - 1);
  LoopedPoses loop = looped(rig, poses,
                            {.repeats = options.repeats,
                             .blend = options.seam >= 0 ? options.seam : static_cast<int>(usual),
                             .stays = options.on_the_spot});
  print(
      "Where repeats meet, poses differ by up to %.1f degrees%s%s; blending them turns bones up to %.2f times as "
      "fast as in the original motion.\n",
      loop.gap_degrees, loop.gap_bone.empty() ? "" : ", in ", loop.gap_bone.c_str(), loop.haste);
  if (loop.haste > 1.5)
    warn("bones turn too fast where repeats meet: use a motion of a whole cycle, or a longer --seam");
  return std::move(loop.poses);
}

void clean(const CleanMotionOptions& options) {
  if (!options.cleans() && !options.mirror && options.speed == 1 && options.repeats == 0)
    throw Error("there is nothing to clean", "clean-motion",
                "add --smooth HZ, --plant-feet, --hold, --mirror, --speed or --loop");
  const ArmatureFile file = read_armature_file(options.rig);
  warn(file.warnings);
  const Armature& rig = file.armature;
  const double rate = 1 / read_bvh(options.motion.motion).frame_time;
  const std::vector<Pose> recorded = read_all_poses(options.motion, rig);
  const std::vector<Pose> smooth = options.smooth > 0 ? smoothed(recorded, rate, options.smooth) : recorded;

  const std::vector<PlantedLimb> limbs = planted_limbs(rig);
  const bool has_legs = std::any_of(limbs.begin(), limbs.end(), [](const PlantedLimb& limb) { return limb.is_leg; });
  if (limbs.empty() && !options.holds.empty())
    throw Error("no arm or leg is recognised in the rig's bone names", options.rig,
                "name its bones as in \"LeftForearm\"");
  if (options.plant_feet && !has_legs)
    throw Error("no leg is recognised in the rig's bone names", options.rig, "name its bones as in \"LeftThigh\"");
  std::vector<Plant> holds;
  for (const std::string& value : options.holds) holds.push_back(hold_of(value, limbs, rig, smooth));
  const auto [cleaned, plants] = clean_motion(rig, limbs, smooth, rate, options.plant_feet, holds, options.ease);
  if (options.plant_feet && plants.size() == holds.size())
    warn("no standing foot was found: no foot stays low and slow for 0.1 s");
  const std::vector<Pose> written = changed(options, rig, rate, cleaned);
  write_bvh(motion_of_poses(rig, static_cast<int>(written.size()), rate, [&](int frame) { return written[frame]; }),
            options.output);
  print_plants(plants, rig, limbs, recorded, cleaned);
  warn_of_short_limbs(plants, rig, limbs, cleaned);
  if (options.cleans()) print("%zu frames cleaned.\n", cleaned.size());
  if (written.size() != cleaned.size()) print("%zu frames written.\n", written.size());
}
}  // namespace

void add_clean_motion(CLI::App& app) {
  auto* command =
      app.add_subcommand("clean-motion", "removes jitter from a motion on a rig, and keeps feet and hands in place");
  auto options = std::make_shared<CleanMotionOptions>();
  options->motion.root_motion = true;
  command->add_option("RIG", options->rig, "the rig that the motion moves")->required();
  auto* motion = command->add_option("--motion", options->motion.motion, "the motion (BVH)")->required();
  add_up_option(*command, options->motion.up, motion);
  command
      ->add_option("--map", options->motion.map,
                   "retarget map (JSON): which joint of the motion moves which rig bone (default: matched by names)")
      ->type_name("M.json");
  add_rest_options(*command, options->motion.rests, motion, motion->get_group());
  command
      ->add_option("--smooth", options->smooth,
                   "remove movement above this frequency, Hz, such as 6 for walking (default: no filter)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--plant-feet", options->plant_feet, "keep each foot in place while it stands on the ground");
  command
      ->add_option("--hold", options->holds,
                   "LIMB=X,Y,Z@FIRST-LAST: keeps the tip of left hand, right hand, left foot or right foot at a "
                   "position (world, mm) in these frames; LIMB@FIRST-LAST: at its position in frame FIRST (repeatable)")
      ->type_name("HOLD")
      ->expected(1)
      ->take_all();
  command->add_option("--ease", options->ease, "seconds over which a limb blends into a held position and out of it")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command->add_flag("--mirror", options->mirror, "swap left and right, and mirror the body's path");
  command
      ->add_option("--speed", options->speed,
                   "speed factor: 2 plays twice as fast, at the same number of frames per second")
      ->check(CLI::Range(kSlowest, kFastest))
      ->capture_default_str();
  auto* loop =
      command
          ->add_option(
              "--loop", options->repeats,
              "total number of times that the motion plays; each repeat continues from the body's position and heading")
          ->check(CLI::Range(1, 1'000'000));
  command
      ->add_option("--seam", options->seam,
                   "with --loop: number of frames in which the end of each repeat is blended into the next (default: "
                   "0.3 seconds)")
      ->check(CLI::Range(0, 1'000'000))
      ->needs(loop);
  command
      ->add_flag("--on-the-spot", options->on_the_spot,
                 "with --loop: keep the body in place, instead of letting it travel from repeat to repeat")
      ->needs(loop);
  writes(
      command->add_option("-o,--output", options->output, "BVH file to write: the cleaned motion, on the rig's bones"))
      ->required();
  command->callback([options] { clean(*options); });
}

}  // namespace limber::cmd
