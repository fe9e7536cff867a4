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

// The kinds of the rest poses (T-pose, A-pose, ...) of the motion and of the rig, in words of rest_pose_kind.h. "": the
// kind that the retarget map says.
struct RestWords {
  std::string motion, rig;
};
void add_rest_options(CLI::App& command, RestWords& words, CLI::Option* needed, const std::string& group);
void take_over(const RestWords& words, RetargetMap& map);  // throws Error for an unknown word

struct PoseOptions {
  std::string pose;               // file name
  PoseRequest body;               // --pose-name and --joint
  std::vector<std::string> flex;  // BONE=DEGREES
  std::string motion;             // file name
  std::optional<int> frame;       // frame of the motion, counted from 0
  std::string up = "y";           // axis that points up in the motion's file: y, z or auto
  std::string map;                // file name
  RestWords rests;
  bool root_motion = false;
};

// Adds --up y|z|auto: the axis that points up in the file of `motion`.
void add_up_option(CLI::App& command, std::string& up, CLI::Option* motion);
// Reads a motion and turns it so that y is up. Warnings go to stderr. One of them says that the file is read with y up
// although its body clearly stands along z.
Motion read_motion(const std::string& file, const std::string& up);

// Adds --pose-name and --joint to the group of the option `pose`, which names a pose file. Returns --pose-name.
CLI::Option* add_body_pose_options(CLI::App& command, PoseRequest& request, CLI::Option* pose);

// Returns true when any pose option was given. --frame alone does not count.
bool wants_pose(const PoseOptions& options);

// Adds the options. `options` must live as long as the command.
void add_pose_options(CLI::App& command, PoseOptions& options);

// Reads the pose that the options describe. Throws Error where it does not fit the rig. Warnings go to stderr.
Pose read_pose_options(const PoseOptions& options, const Armature& armature);

// Returns the poses of all frames of --motion. Throws Error without --motion.
std::vector<Pose> read_all_poses(const PoseOptions& options, const Armature& armature);

}  // namespace limber::cmd
