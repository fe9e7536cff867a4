// SPDX-License-Identifier: AGPL-3.0-or-later
// Joints that glide: a pose turns every bone exactly as asked, and where the bones of a joint would overlap then, the
// bone that turns is shifted by the least translation that frees it, and with it all that hangs on it. A rig's joint
// is one fixed axis or centre; real joints roll, glide and open, and rigs lie some millimetres off. Axes are not
// touched: fitting them is an edit of the rig (core/autorig/joint_axis_fit.h).
//
// A joint is between a rig bone with bone tissue and the nearest bone above it that has some. Which tissue that is
// say the weights, as where bones are painted. A shift does not change how other joints stand, so each is found by
// itself (core/bones/least_shift.h). Bones that meet without a joint between them, as siblings do, are not looked at.
//
// Whole bodies of 3 mm that sit, with rigs whose knees and elbows lie some 10 mm off their anatomical axes, need
// shifts of 6 to 8 mm in the elbow and 20 in the knee; hips and shoulders that lie well need none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/rig/pose.h"
#include "core/skin/skin_weights.h"
#include "core/volume/label_sampler.h"

namespace limber {

struct GlideSettings {
  double most_share = 0.05;       // longest shift of a joint, of the length of the shorter of its two rig bones
  std::optional<double> most_mm;  // the same in mm, instead
  // And no bone further than that from where the pose puts it, by all shifts above it together.
  std::optional<double> whole_mm;
};

// A joint whose bones overlap as the pose turns them.
struct GlidedJoint {
  std::string bone, against;  // the rig bone that is shifted, and the one that it would overlap
  glm::dvec3 shift{0};        // world axes of the posed body, mm
  double most_mm = 0;         // what it may be shifted by
  bool free = true;           // whether the bones no longer overlap by more than half a voxel
  double depth_before = 0;    // mm, of the overlap beyond half a voxel, at its deepest: without the shift
  double depth_after = 0;     // and with it
};

struct GlidedPose {
  Pose pose;                        // with the shifts; as it was given where nothing overlaps
  std::vector<GlidedJoint> joints;  // in the rig's order
};

//   weights  rigid in bone tissue (with_rigid_bones)        is_bone  per label
// throws Error when the weights are of a bone that the rig does not have
GlidedPose glide_joints(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                        const SkinWeights& weights, const Armature& armature, const Pose& pose,
                        const GlideSettings& settings = {}, Progress& progress = no_progress());

}  // namespace limber
