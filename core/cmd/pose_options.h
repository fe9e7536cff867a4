// SPDX-License-Identifier: AGPL-3.0-or-later
// How a command is told a pose:
//   --pose P.json | --motion F.bvh --frame N [--up y|z|auto] [--map M.json] [--motion-rest POSE] [--rig-rest POSE]
//   [--root-motion]
// then, on top of it, joints by what clinicians call them, and any number of bones about their hinges
//   [--pose-name NAME] [--joint "JOINT MOTION=DEG"]... [--flex BONE=DEG]...
// Without any of them the pose is rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/motion/retarget.h"
#include "core/pose/body_poses.h"
#include "core/rig/pose.h"

namespace limber::cmd {

// What motion and rig rest in: words of rest_pose_kind.h; "": as the map says.
struct RestWords {
  std::string motion, rig;
};
void add_rest_options(CLI::App& command, RestWords& words, CLI::Option* needed, const std::string& group);
void take_over(const RestWords& words, RetargetMap& map);  // throws Error for what is no such word

struct PoseOptions {
  std::string pose;               // file
  PoseRequest body;               // --pose-name and --joint
  std::vector<std::string> flex;  // BONE=DEG
  std::string motion;             // file
  std::optional<int> frame;       // of the motion, from 0
  std::string up = "y";           // of the motion's file: y, z, or auto
  std::string map;                // file
  RestWords rests;
  bool root_motion = false;
};

// --up y|z|auto: the axis that points up in the file of `motion`.
void add_up_option(CLI::App& command, std::string& up, CLI::Option* motion);
// The motion with y up. Its warnings go to stderr, with one where it is read with y up but clearly stands along z.
Motion read_motion(const std::string& file, const std::string& up);

// --pose-name and --joint, beside the option of a pose's file; returns the first.
CLI::Option* add_body_pose_options(CLI::App& command, PoseRequest& request, CLI::Option* pose);

// True when any of them was given; --frame alone is not.
bool wants_pose(const PoseOptions& options);

// `options` must live as long as the command.
void add_pose_options(CLI::App& command, PoseOptions& options);

// Throws Error for what does not fit the rig; warnings of the files go to stderr.
Pose read_pose_options(const PoseOptions& options, const Armature& armature);

// Of every frame of --motion. Throws Error without one.
std::vector<Pose> read_all_poses(const PoseOptions& options, const Armature& armature);

}  // namespace limber::cmd
