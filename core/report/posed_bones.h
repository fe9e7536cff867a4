// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how the body's bones moved in a posed volume, from the displacement of their voxels. It measures whether
// each bone that a label names stayed whole and followed the rig bone that it belongs to, and how far each limb's
// direction is from the requested one. It uses neither weights nor the program's own split of bone tissue into bones.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_identity.h"
#include "core/report/judged_pose.h"
#include "core/report/whole_bones.h"

namespace limber {

// The measured direction of a rig bone that the pose moves.
struct LimbDirection {
  std::string bone;
  double direction_degrees = 0;    // angle between the requested and the measured direction of the bone
  double orientation_degrees = 0;  // angle between the requested and the measured rotation
  std::int64_t voxels = 0;         // number of bone voxels that were measured
  bool by_name = false;  // true: measured on bones with names; false: on bone tissue around the middle of its axis
};

struct PosedBones {
  std::vector<WholeBone> whole;      // sorted by label, then side; labels that name no bone are left out
  std::vector<LimbDirection> limbs;  // in the rig's order; bones with fewer than 30 voxels are left out
};

// Measures a pose, which must have the displacement and the rig. A voxel is wrong where each rig bone that its label
// may follow would take it further than the longest voxel edge from its posed position. residual_mm is the largest
// distance of a voxel of the bone from its position under the best rigid motion of all these voxels.
PosedBones measure_posed_bones(const JudgedPose& pose, const BoneMap& map = {});

}  // namespace limber
