// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits the axis of a joint to the bones around it. The joint of a rig is rarely at the anatomical position, so rotating
// about it moves bone into bone. The axis is moved and tilted as little as possible so that the bones that rotate with
// the joint do not enter the fixed bones at any angle of a range.
//
// The fixed bones become a signed distance field. The surface voxels of the rotating bones are moved through the range,
// and the depth by which they exceed a margin adds to the cost. With the squared motion of the axis as a second term
// this is a least-squares problem in four variables (two shifts across the axis, two tilts), solved by
// Levenberg-Marquardt [More 1978] with a rising weight of the collisions. The search ends at the first axis for which
// no voxel would be filled by both sides at any degree of the range. That axis is then moved back towards the old one
// as far as this stays true.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_parts.h"
#include "core/rig/pose.h"

namespace limber {

struct FitJoint {
  // Range of flexion angles in which the joint must be free of collisions.
  double minimum_degrees = 0, maximum_degrees = 90;
  double reach_mm = 120;            // bone farther than this from the joint is ignored, as no axis could separate it
  double most_moved_mm = 30;        // the fit shifts the axis by at most this, mm
  double most_turned_degrees = 20;  // the fit tilts the axis by at most this, degrees
};

struct FittedJoint {
  // The fitted rig: the bone's head is moved and, if its parent's tail coincided with it, this tail too. The bone's
  // joint limits are a hinge about the fitted axis.
  Armature armature;
  double moved_mm = 0;        // shift of the bone's head perpendicular to the axis, mm
  double turned_degrees = 0;  // tilt of the axis, degrees
  // Number of voxels that bones of both sides fill, at the worst angle of the range, before and after the fit.
  std::int64_t overlap_before = 0, overlap_after = 0;
  // Rest positions of the voxels of both sides that collide at some angle, before and after the fit.
  std::vector<glm::ivec3> colliding_before, colliding_after;
};

// Fits the axis of a hinge joint. The fit starts from the axis through the bone's head along flex_axis().
// throws Error when the bone has no flex axis, the range is not within +-180 degrees, or one side has no bone tissue
FittedJoint fit_joint(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, int bone, const FitJoint& settings = {},
                      Progress& progress = no_progress());

// The result of fit_joints(), which fits the axis of every joint that a pose rotates by more than 5 degrees, parents
// first. Each axis is fitted for the angles from 0 to the joint's rotation in the pose. A joint with no bone tissue on
// one side is not changed.
struct FittedPose {
  struct Joint {
    std::string bone;
    double moved_mm = 0, turned_degrees = 0;
    std::int64_t overlap_before = 0, overlap_after = 0;
  };
  Armature armature;
  Pose pose;                  // the given pose with the same joint angles, but about the fitted axes
  std::vector<Joint> joints;  // joints that collided before the fit or whose axis moved
  // One line for each joint whose bones still collide, with the number of colliding voxels.
  std::vector<std::string> warnings;
};
FittedPose fit_joints(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, const Pose& pose, Progress& progress = no_progress());

}  // namespace limber
