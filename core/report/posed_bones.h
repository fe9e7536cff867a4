// SPDX-License-Identifier: AGPL-3.0-or-later
// How the bones of the body went in a posed volume, measured from the displacement of their voxels: whether each bone
// that a label names stayed whole and went with the rig bone it belongs to, and in which direction each limb points
// against what was asked. Neither weights nor the program's bone parts are looked at.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_identity.h"
#include "core/report/judged_pose.h"
#include "core/report/whole_bones.h"

namespace limber {

// A rig bone that the pose turns, or whose parent it turns.
struct LimbDirection {
  std::string bone;
  double direction_degrees = 0;    // between the direction of the bone asked for and the one reached
  double orientation_degrees = 0;  // the same with the turn about the bone's own axis
  std::int64_t voxels = 0;         // of bone tissue that it was measured from
  bool by_name =
      false;  // these voxels are named bones that belong to it; else bone tissue around the middle of its axis
};

struct PosedBones {
  std::vector<WholeBone> whole;      // by label, then side; labels that name no bone are left out
  std::vector<LimbDirection> limbs;  // in the rig's order; those with fewer than 30 voxels of bone tissue are left out
};

// Needs the displacement and the rig. A voxel is wrong where no rig bone that its label may follow takes it within a
// voxel's longest edge of where it went; residual_mm is the largest distance from the best rigid motion of all voxels
// of the bone.
PosedBones measure_posed_bones(const JudgedPose& pose, const BoneMap& map = {});

}  // namespace limber
