// SPDX-License-Identifier: AGPL-3.0-or-later
// Lets joints glide. If the two bones of a joint overlap in a pose, the rotated bone and all its descendants are
// shifted by the shortest translation that separates the two bones; the rotations stay as the pose asks. This is needed
// because a rig's joint turns about a fixed axis or centre, while real joints roll, glide and open, and because the
// axes of rigs are some millimetres off. The axes themselves are not changed here: fitting them is an edit of the rig
// (core/autorig/joint_axis_fit.h).
//
// A joint lies between a rig bone with bone tissue and its nearest ancestor with bone tissue. The weights say which
// tissue belongs to which rig bone. A shift does not change the angles of other joints, so the shift of each joint is
// found separately (core/bones/least_shift.h). Bones that touch without a joint between them, such as siblings, are not
// examined.
//
// In whole bodies of 3 mm voxels that are posed to sit, with rigs whose knees and elbows lie some 10 mm off their
// anatomical axes, the elbow needs shifts of 6 to 8 mm and the knee 20 mm. Hips and shoulders with well-fitted axes
// need none.
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
  // A joint is shifted by at most this share of the length of the shorter of its two rig bones.
  double most_share = 0.05;
  // A joint is shifted by at most this length, mm, instead of the share most_share. None: most_share is the limit.
  std::optional<double> most_mm;
  // Upper limit, mm, on the length of the sum of a bone's own shift and the shifts of all its ancestors. A longer sum
  // is not allowed, however far the bones then overlap. None: no limit.
  std::optional<double> whole_mm;
};

// A joint whose bones overlap when the pose rotates them, and the shift found for it.
struct GlidedJoint {
  std::string bone, against;  // the rig bone that is shifted; the rig bone that it would overlap
  glm::dvec3 shift{0};        // shift of the bone along the world axes, mm
  double most_mm = 0;         // upper limit on the length of the shift, mm
  bool free = true;           // true: with the shift the bones overlap by half a voxel at most
  double depth_before = 0;    // how far the deepest overlap exceeds half a voxel without the shift, mm
  double depth_after = 0;     // how far the deepest overlap exceeds half a voxel with the shift, mm
};

struct GlidedPose {
  Pose pose;                        // the given pose and the shifts that separate its joints
  std::vector<GlidedJoint> joints;  // the joints whose bones would overlap, in the order of the rig's bones
};

// Returns the pose with the shifts that separate the bones of its joints.
//   weights  rigid in bone tissue (with_rigid_bones)        is_bone  1 for each label that is bone tissue
// throws Error when the weights name a bone that the rig does not have
GlidedPose glide_joints(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                        const SkinWeights& weights, const Armature& armature, const Pose& pose,
                        const GlideSettings& settings = {}, Progress& progress = no_progress());

}  // namespace limber
