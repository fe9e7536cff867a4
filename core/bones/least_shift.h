// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the smallest translation that separates one bone from another. Bones overlap where the sum of their signed
// distances is negative. Between the surfaces, this sum is the width of the gap or, if negative, the depth of the
// overlap; when a bone moves by 1 mm, the sum changes by at most 1 mm. The sum is sampled at the surface points of both
// bones. At rest it is never negative, since a voxel belongs to one bone only.
//
// An overlap of half a voxel is allowed, since the surfaces in a volume are no more exact than that, and less exact if
// slices are thick. The cost is the square of the shift plus the weighted squares of all deeper overlaps, with a rising
// weight. This problem in three variables is solved by Levenberg-Marquardt [More 1978]. The search follows the joint's
// rotation step by step, so that the bone is pushed back to the side from which it comes, even if the other bone is
// thin. Finally, bisection shortens the shift as far as the bones stay separate.
#pragma once

#include <vector>

#include "core/bones/bone_distance.h"
#include "core/volume/grid.h"

namespace limber {

// The distance fields of two bones that meet in a joint. Each field covers the neighbourhood of the other bone; both
// are given in the grid's axes at rest.
struct JointBones {
  const BoneDistance& fixed;
  const BoneDistance& turning;
  glm::dvec3 spacing;  // voxel spacing of the volume, mm
};

struct LeastShift {
  glm::dvec3 shift{0};  // the shift, mm; exactly zero if the bones do not overlap
  bool free = true;     // true: after the shift, no overlap exceeds half a voxel by more than a twentieth of a voxel
  double depth_before = 0;  // how far the deepest overlap exceeds half a voxel without the shift, mm
  double depth_after = 0;   // how far the deepest overlap exceeds half a voxel with the shift, mm
};

// Limits on a shift. A bone that needs a longer shift is shifted only as far as the limits allow.
struct ShiftBound {
  double most_mm;         // longer shifts are shortened to this, mm
  double whole_mm = 1e9;  // upper limit on the length of the sum of `shift` and `carried`, mm
  glm::dvec3 carried{0};  // shift that the joints above give to the fixed bone, mm; no longer than whole_mm
};

// Returns the smallest shift of the turning bone that separates it from the fixed bone. The shift is given along the
// axes of the grid in the frame of the fixed bone, and is applied after the motion.
//   path  rigid motions of the turning bone in steps of about ten degrees; the last one is the pose
LeastShift least_shift(const JointBones& bones, const std::vector<AffineTransform>& path, const ShiftBound& bound);

}  // namespace limber
