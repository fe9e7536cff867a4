// SPDX-License-Identifier: AGPL-3.0-or-later
// The least translation of one bone that frees it from another. The bones overlap where the sum of their signed
// distances is negative: along the way from one surface to the other that sum is the width of the gap between them,
// or less than zero the depth of the overlap, and moving a bone by a millimetre changes it by a millimetre at most.
// It is sampled at the surface points of both bones; at rest it is nowhere negative, since a voxel belongs to one
// bone.
//
// Bones may overlap by half a voxel: so far off may their drawn surfaces be, more so where slices are thick. What is
// deeper pays by its square, beside the square of the shift, under a rising weight: a problem of three numbers,
// solved by Levenberg-Marquardt [More 1978]. The bone is led to its place along the way that the joint turns, so that
// it is pushed back to the side that it comes from, also where the other bone is thin. Last the shift is shortened by
// bisection as far as the bone stays free.
#pragma once

#include <vector>

#include "core/bones/bone_distance.h"
#include "core/volume/grid.h"

namespace limber {

// Two bones that meet in a joint, each in the box that the other can come to, both in the same frame at rest.
struct JointBones {
  const BoneDistance& fixed;
  const BoneDistance& turning;
  glm::dvec3 spacing;  // of the volume, mm
};

struct LeastShift {
  glm::dvec3 shift{0};  // mm; exactly zero where nothing overlaps without
  bool free = true;     // whether nothing overlaps any more, by more than a twentieth of a voxel beyond what is allowed
  double depth_before = 0;  // mm, of the deepest place: by how much the bones overlap beyond half a voxel
  double depth_after = 0;
};

// How long a shift may be. What would need more is led as far as that goes.
struct ShiftBound {
  double most_mm;         // of the shift itself
  double whole_mm = 1e9;  // of the shift and of what the fixed bone has been carried along by, together
  glm::dvec3 carried{0};  // mm, no longer than whole_mm
};

//   path      rigid motions of the turning bone, the last one where it shall be; as steps of some ten degrees
// Shifts are along the axes of the grid as the fixed bone stands, after the motion.
LeastShift least_shift(const JointBones& bones, const std::vector<AffineTransform>& path, const ShiftBound& bound);

}  // namespace limber
