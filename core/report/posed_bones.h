// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how the body's bones moved in a posed volume, from the displacement of their voxels: whether each bone that
// a label names stayed whole and followed the rig bone that it belongs to, and how far each limb's direction is from
// the requested one. It uses neither weights nor the bones into which this program splits bone tissue, so that errors
// in these are found.
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
  bool by_name = false;  // true: measured on bones that labels name; false: on bone tissue at the axis' middle
};

struct PosedBoneMeasures {
  std::vector<WholeBone> whole;      // sorted by label, then side; labels that name no bone are left out
  std::vector<LimbDirection> limbs;  // in the order of the rig's bones; those with fewer than 30 voxels are left out
};

// Measures a pose, which must have the displacement and the rig. A voxel counts as wrong if none of the rig bones that
// its label may follow moves it to within a voxel edge (the longest) of its posed position. For a bone's residual_mm,
// the rigid motion that fits all its voxels best is found; the residual is the largest distance of a voxel from the
// position to which this motion moves it.
PosedBoneMeasures measure_posed_bones(const JudgedPose& pose, const BoneMap& map = {});

}  // namespace limber
