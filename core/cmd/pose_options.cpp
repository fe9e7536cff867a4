// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/pose_options.h"

#include <set>

#include "core/base/error.h"
#include "core/cmd/command.h"
#include "core/motion/motion_edit.h"
#include "core/motion/up_axis.h"
#include "core/pose/flex_request.h"
#include "core/pose/pose_io.h"

namespace limber::cmd {

namespace {
// Applies the requested joint angles to the pose, then the hinge flexions.
void apply_requests(Pose& pose, const Armature& armature, const PoseOptions& options, std::set<std::string>& warnings) {
  std::vector<std::string> lines;
  pose = with_request(armature, pose, options.body, lines);
  warnings.insert(lines.begin(), lines.end());
  for (const std::string& request : options.flex) {
    const FlexRequest asked = parse_flex_request(request, "--flex");
    flex(pose, armature, require_bone(armature, asked.bone), asked.degrees);
  }
}

// Returns the pose of frame `frame` of the motion. Returns the poses of all frames if `frame` is empty.
std::vector<Pose> poses_of_motion(const PoseOptions& options, const Armature& armature, std::optional<int> frame) {
  const Motion motion = read_motion(options.motion, options.up);
  RetargetMap map =
      options.map.empty() ? match_by_names(motion, armature) : read_retarget_map(options.map, motion, armature);
  take_over(options.rests, map);
  const Retarget retarget(motion, armature, map, {.travel = options.root_motion ? Travel::Free : Travel::Locked});
  if (frame) return {retarget.at(*frame)};
  std::vector<Pose> poses;
  for (int f = 0; f < motion.frame_count; ++f) poses.push_back(retarget.at(f));
  return poses;
}
}  // namespace

void add_up_option(CLI::App& command, std::string& up, CLI::Option* motion) {
  command
      .add_option(
          "--up", up,
          "axis that points up in the motion file: y, z, or auto: guessed from the posture of the body in the motion")
      ->type_name("y|z|auto")
      ->check(CLI::IsMember({"y", "z", "auto"}))
      ->needs(motion)
      ->group(motion->get_group());
}

Motion read_motion(const std::string& file, const std::string& up) {
  Motion motion = read_bvh(file);
  warn(motion.warnings);
  const UpGuess guess = up_axis_of(motion);
  const bool stands_along_z = guess.axis == UpAxis::Z;
  if (stands_along_z && up == "y")
    warn(file + " is read with y as the up axis, but " + reason_of(guess) + ": add --up z");
  return up == "z" || (up == "auto" && stands_along_z) ? y_up_from_z_up(motion) : motion;
}

void add_rest_options(CLI::App& command, RestWords& words, CLI::Option* needed, const std::string& group) {
  const std::string which = ": T, A, anatomical, or file: the pose as stored (default: from the retarget map)";
  command.add_option("--motion-rest", words.motion, "treat the motion's rest pose as this pose" + which)
      ->type_name("POSE")
      ->needs(needed)
      ->group(group);
  command.add_option("--rig-rest", words.rig, "treat the rig's rest pose as this pose" + which)
      ->type_name("POSE")
      ->needs(needed)
      ->group(group);
}

void take_over(const RestWords& words, RetargetMap& map) {
  if (!words.motion.empty()) map.stances.source = stance_of_word(words.motion, "--motion-rest");
  if (!words.rig.empty()) map.stances.rig = stance_of_word(words.rig, "--rig-rest");
}

CLI::Option* add_body_pose_options(CLI::App& command, PoseRequest& request, CLI::Option* pose) {
  std::string names;
  for (const BodyPose& one : body_poses()) names += (names.empty() ? "" : ", ") + std::string(one.name);
  auto* name = command
                   .add_option("--pose-name", request.name,
                               "built-in pose for a rig whose joints are known by their bones' names: " + names)
                   ->type_name("NAME")
                   ->excludes(pose)
                   ->group(pose->get_group());
  // Without this check, an empty name would silently mean that no pose is requested.
  name->check(
      [](const std::string& given) { return given.empty() ? std::string("write a pose's name") : std::string(); }, "");
  command
      .add_option("--joint", request.joints,
                  "angle of a joint in degrees from the anatomical position; replaces the angle of --pose-name "
                  "(repeatable): \"left hip flexion=90\", \"knees flexion=60\"")
      ->type_name("\"JOINT MOTION=DEG\"")
      ->expected(1)
      ->take_all()
      ->group(pose->get_group());
  return name;
}

void add_pose_options(CLI::App& command, PoseOptions& options) {
  const std::string group = "Pose";
  auto* pose = command.add_option("--pose", options.pose, "pose file (JSON)")->type_name("P.json")->group(group);
  auto* name = add_body_pose_options(command, options.body, pose);
  command
      .add_option("--flex", options.flex, "turn a bone about its hinge by degrees, positive bends further (repeatable)")
      ->type_name("BONE=DEG")
      ->expected(1)
      ->take_all()
      ->group(group);
  auto* motion = command.add_option("--motion", options.motion, "motion capture (BVH) to take the pose from")
                     ->type_name("F.bvh")
                     ->excludes(pose)
                     ->excludes(name)
                     ->group(group);
  command.add_option("--frame", options.frame, "frame of the motion to take the pose from, counted from 0")
      ->type_name("N")
      ->check(CLI::NonNegativeNumber)
      ->group(group);
  add_up_option(command, options.up, motion);
  command
      .add_option("--map", options.map,
                  "retarget map (JSON): which joint of the motion moves which rig bone (default: matched by names)")
      ->type_name("M.json")
      ->needs(motion)
      ->group(group);
  add_rest_options(command, options.rests, motion, group);
  command
      .add_flag("--root-motion", options.root_motion,
                "move the body along the ground as the motion does (default: keep it at its rest position)")
      ->needs(motion)
      ->group(group);
}

bool wants_pose(const PoseOptions& options) {
  return !options.pose.empty() || !options.body.empty() || !options.flex.empty() || !options.motion.empty();
}

Pose read_pose_options(const PoseOptions& options, const Armature& armature) {
  if (options.frame && options.motion.empty())
    throw Error("--frame needs a motion", "--frame " + std::to_string(*options.frame), "add --motion F.bvh");
  Pose pose = rest_pose(armature);
  if (!options.pose.empty()) pose = read_pose(options.pose, armature);
  if (!options.motion.empty()) pose = poses_of_motion(options, armature, options.frame.value_or(0)).front();
  std::set<std::string> warnings;
  apply_requests(pose, armature, options, warnings);
  for (const std::string& line : warnings) warn(line);
  return pose;
}

std::vector<Pose> read_all_poses(const PoseOptions& options, const Armature& armature) {
  if (options.motion.empty())
    throw Error("there is no motion to take frames from", "--all-frames", "add --motion F.bvh");
  std::vector<Pose> poses = poses_of_motion(options, armature, {});
  std::set<std::string> warnings;
  for (Pose& pose : poses) apply_requests(pose, armature, options, warnings);
  for (const std::string& line : warnings) warn(line);
  return poses;
}

}  // namespace limber::cmd
