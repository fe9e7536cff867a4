// SPDX-License-Identifier: AGPL-3.0-or-later
// One pose of a study or batch, as the description file states it:
//   {"name": "+45", "flex": ["Forearm=45"]}
//   {"name": "seated", "pose_name": "sit", "joints": ["left elbow flexion=30"]}
//   {"name": "mine", "pose": "p.json"}
//   {"name": "curl", "motion": "curl.bvh", "frame": 12, "map"?, "up"?}
//   {"name": "walk", "motion": "walk.bvh", "frames": "0:60:5", "map"?, "up"?}
// The last form stands for one pose for each of these frames, 60 included: "walk 0000", "walk 0005", ...
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/pose/body_poses.h"

namespace limber {

struct DescribedPose {
  std::string name;
  std::vector<std::string> flex;  // requests BONE=DEGREES; if `flex`, `body` and all files are empty: the rest pose
  PoseRequest body;               // values of the keys "pose_name" and "joints"
  Path pose, motion, map;         // pose file, motion file and retarget map; empty: no such file
  std::optional<int> frame;
  std::string up;
  std::string sequence;  // for a pose of "frames": the name without the frame's number; empty: a single pose

  bool is_rest() const { return flex.empty() && body.empty() && pose.empty() && motion.empty(); }
};

}  // namespace limber
