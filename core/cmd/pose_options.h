// SPDX-License-Identifier: AGPL-3.0-or-later
// The options that name a pose:
//   --pose P.json | --motion F.bvh --frame N [--up y|z|auto] [--map M.json] [--motion-rest POSE] [--rig-rest POSE]
//   [--root-motion]
// and on top of it a named body pose, joint angles in clinical terms, and rotations of bones about their hinges:
//   [--pose-name NAME] [--joint "JOINT MOTION=DEG"]... [--flex BONE=DEG]...
// Without any of these options the pose is the rest pose.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/motion/retarget.h"
#include "core/pose/body_poses.h"
#include "core/rig/pose.h"

namespace limber::cmd {

// The rest poses of the motion and of the rig (T-pose, A-pose, ...), as words of rest_pose_kind.h. "": the rest pose
// that the retarget map names.
struct RestWords {
  std::string motion, rig;
};
void add_rest_options(CLI::App& command, RestWords& words, CLI::Option* needed, const std::string& group);
void take_over(const RestWords& words, RetargetMap& map);  // throws Error for an unknown word

struct PoseOptions {
  std::string pose;               // name of the pose file
  PoseRequest body;               // values of --pose-name and --joint
  std::vector<std::string> flex;  // values of --flex: BONE=DEGREES
  std::string motion;             // name of the motion's file
  std::optional<int> frame;       // frame of the motion, counted from 0
  std::string up = "y";           // axis that points up in the motion's file: y, z or auto
  std::string map;                // name of the file with the retarget map
  RestWords rests;
  bool root_motion = false;
};

// Adds the option --up y|z|auto: the axis that points up in the motion's file.
//   motion  the option that names the motion's file, which --up needs
void add_up_option(CLI::App& command, std::string& up, CLI::Option* motion);
// Reads a motion and turns it so that y is up. Warnings go to stderr, for example when the file is read with y up
// although its body clearly stands along z.
Motion read_motion(const std::string& file, const std::string& up);

// Adds the options --pose-name and --joint, and returns the option --pose-name.
//   pose  the option that names a pose file, which excludes --pose-name; the new options get its help group
CLI::Option* add_body_pose_options(CLI::App& command, PoseRequest& request, CLI::Option* pose);

// Returns true when any pose option was given. --frame alone does not count.
bool wants_pose(const PoseOptions& options);

// Adds all options that name a pose. `options` must live as long as the command.
void add_pose_options(CLI::App& command, PoseOptions& options);

// Reads the pose that the options describe. Throws Error if the pose does not fit the rig. Warnings go to stderr.
Pose read_pose_options(const PoseOptions& options, const Armature& armature);

// Returns the poses of all frames of --motion. Throws Error without --motion.
std::vector<Pose> read_all_poses(const PoseOptions& options, const Armature& armature);

}  // namespace limber::cmd
