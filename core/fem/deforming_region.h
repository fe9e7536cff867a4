// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the part of a body that a pose deforms. Tissue whose bones all have the same motion moves with them as a rigid
// body and needs no elements, so the cost of a pose depends on the amount of tissue that deforms, not on the size of
// the body.
//
// Tissue bends where its weights, or those of its neighbours, are on bones with different motions. Bending tissue also
// pulls on the tissue around it, so tissue within a margin around it may deform too. Contact can also press tissue in:
// tissue that the pose brings near another part of the body may deform, and so may the tissue close around it. This
// tissue becomes free at the path position where contact can first happen; before, it moves with its bone. All tissue
// that may deform is surrounded by a rim that is meshed but moves rigidly; there the mesh connects to tissue that is
// not meshed. All decisions are made for cells of 4^3 voxels.
#pragma once

#include <array>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/inverse_map.h"
#include "core/fem/solve_pose.h"
#include "core/skin/skin_weights.h"

namespace limber {

// An object that moves to the body: points of its surface at its target position, mm, and the possible ways to this
// position. A way gives the motion of each point per mm that the object is away from the target position.
struct ObjectSweep {
  std::vector<glm::dvec3> point;
  std::vector<std::vector<glm::dvec3>> ways;
  double deepest_mm = 0;  // distance by which the object may move beyond its target position
};
// The shortest way on which an object leaves the body: its index in ObjectSweep::ways, and its length, mm. Infinite
// length: the body blocks all ways.
struct ObjectClearance {
  std::size_t way = 0;
  double mm = 0;
  bool presses = false;  // true: the object comes near tissue at one or more of the tested positions
};

struct MovingSettings {
  double margin_mm = 30;  // largest distance from bending tissue at which tissue may deform
  double rim_mm = 20;     // width of the rigid rim around the tissue that may deform
  bool contact = false;   // true: contact between parts of the body may deform them
  double near_mm = 16;    // parts of the body that the pose brings closer than this may touch
  double give_mm = 24;    // largest distance from parts that may touch at which tissue may deform
  // Positions on the path, [0, 1], in ascending order. Contact is tested at these positions and, where parts of the
  // body move further than near_mm from one position to the next, also between them.
  std::vector<double> places{0.25, 0.5, 0.75, 1};
  // Objects that move to the body, and the path positions at which they may press on it. Tissue that they meet may
  // deform.
  std::vector<ObjectSweep> sweeps;
  std::vector<double> pressed_at;
};

struct DeformingRegion {
  std::vector<int> moves_as;  // #bones: index of the first bone that has the same motion all along the path
  TissueMask free;            // tissue that may deform
  // The position on the path, [0, 1], up to which each cell moves as a rigid body; infinite: along the whole path. One
  // list per brick (cube of 8^3 voxels) with the values of its 8 cells, x fastest.
  std::vector<std::array<float, 8>> free_from;
  TissueMask meshed;                        // the tissue that may deform, and the rim around it
  std::vector<ObjectClearance> clearances;  // one for each sweep, at the first position of `pressed_at`

  bool empty() const;  // true if no tissue may deform
  // Returns the path position, [0, 1], up to which the cell of a tissue voxel moves rigidly (free_from).
  float free_from_at(const TissueVoxels& tissue, const glm::ivec3& voxel) const;
};

// Finds the tissue that the motion of the bones along `path` deforms.
//   weights  each voxel of bone tissue follows one bone with full weight
//   path     motions of the bones of `weights`
DeformingRegion moving_tissue(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                              const BonePath& path, const MovingSettings& settings = {},
                              Progress& progress = no_progress());

// Returns a copy of the weights in which each voxel that does not deform follows one bone with full weight: the bone
// whose motion has most of the voxel's weight.
SkinWeights with_rigid_rest(const SkinWeights& weights, const TissueVoxels& tissue, const DeformingRegion& moving);

}  // namespace limber
