// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits the axis of a joint to the bones around it. A rig's joint is rarely the anatomical one: turning about it drives
// bone into bone. The axis, its place and its direction, is moved as little as possible so that the bones that turn
// with the joint nowhere enter those that stay, at any angle of a range.
//
// The bones that stay become a signed distance field; the surface voxels of those that turn are carried through the
// range and pay for every millimetre that they are deeper than a margin. With the squared motion of the axis as second
// term this is a least-squares problem in four numbers (two shifts across the axis, two tilts), solved by
// Levenberg-Marquardt [More 1978] under a rising weight of the collisions. It ends at the first axis for which not one
// voxel would be painted twice, every degree of the range, which is then drawn back towards the old axis as far as
// that stays true.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_parts.h"
#include "core/rig/pose.h"

namespace limber {

struct FitJoint {
  double minimum_degrees = 0, maximum_degrees = 90;  // range of the flex that must stay free of collision
  double reach_mm = 120;      // bone farther than this from the joint is left out: no axis could keep it apart
  double most_moved_mm = 30;  // of the axis; a fit that needs more is given up
  double most_turned_degrees = 20;
};

struct FittedJoint {
  Armature armature;          // head moved (and the parent's tail, where it met it), hinge stored in limits
  double moved_mm = 0;        // of the head, across the axis
  double turned_degrees = 0;  // of the axis
  std::int64_t overlap_before = 0, overlap_after = 0;  // largest number of colliding bone voxels over the range
  std::vector<glm::ivec3> colliding_before,
      colliding_after;  // voxels of both sides, at rest, that collide at some angle
};

// The hinge through the bone's head along its flex_axis(), fitted.
// throws Error when the bone has no flex axis, the range is not within +-180 degrees, or one side has no bone tissue
FittedJoint fit_joint(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, int bone, const FitJoint& settings = {},
                      Progress& progress = no_progress());

// Every joint that a pose turns by more than 5 degrees, fitted for the turn it makes, parents first. A joint with no
// bone tissue on one side stays as it is.
struct FittedPose {
  struct Joint {
    std::string bone;
    double moved_mm = 0, turned_degrees = 0;
    std::int64_t overlap_before = 0, overlap_after = 0;
  };
  Armature armature;
  Pose pose;                          // the same turns, about the fitted axes
  std::vector<Joint> joints;          // those that collided before
  std::vector<std::string> warnings;  // one line per joint that still collides, with its count
};
FittedPose fit_joints(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                      const Armature& armature, const Pose& pose, Progress& progress = no_progress());

}  // namespace limber
