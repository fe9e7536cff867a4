// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the part of a body that a pose deforms. Tissue whose bones all move alike moves with them as a rigid body and
// needs no elements, so the cost of a pose depends on what moves, not on the size of the body.
//
// Tissue bends where its influences, or those of its neighbours, are bones that move differently. Elasticity acts
// further than weights do, so tissue within a margin around bending tissue may deform too. Contact can also press
// tissue in: so tissue that the pose brings near another part of the body may deform, and tissue close around it. This
// tissue becomes free at the position on the path where contact can first happen. Around all tissue that may deform
// lies a rim, which is meshed but moves rigidly; there the mesh joins tissue that is not meshed. All decisions are made
// for cells of 4^3 voxels.
#pragma once

#include <array>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/inverse_map.h"
#include "core/fem/solve_pose.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct MovingSettings {
  double margin_mm = 30;  // tissue within this distance of tissue that bends by its weights may deform
  double rim_mm = 20;     // width of the rigid rim around the tissue that may deform
  bool contact = false;   // whether contact may deform tissue
  double near_mm = 16;    // contact deforms parts of the body that the pose brings this close to each other
  double give_mm = 24;    // contact also deforms tissue this close to those parts
  std::vector<double> places{0.25, 0.5, 0.75, 1};  // positions on the path at which contact is tested, [0, 1]
};

struct DeformingRegion {
  std::vector<int> moves_as;  // per bone of the weights: the first bone that moves like it all along the path
  TissueMask free;            // tissue that may deform
  // Per brick, for its 8 cells along x, then y, then z: the position on the path before which the cell moves as a rigid
  // body. Infinite: it always does.
  std::vector<std::array<float, 8>> free_from;
  TissueMask meshed;  // the tissue that may deform, and the rim around it

  bool empty() const;  // whether no tissue deforms
  // Returns the value of free_from for the cell around a voxel of tissue.
  float free_from_at(const TissueVoxels& tissue, const glm::ivec3& voxel) const;
};

// Finds the tissue that the motion of the bones along `path` deforms.
//   weights  each voxel of bone tissue follows one bone with full weight
//   path     motions of the bones of `weights`
DeformingRegion moving_tissue(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                              const BonePath& path, const MovingSettings& settings = {},
                              Progress& progress = no_progress());

// Returns the weights with full weight on one bone for each voxel that does not deform: the bone whose motion has most
// of the voxel's weight.
SkinWeights with_rigid_rest(const SkinWeights& weights, const TissueVoxels& tissue, const DeformingRegion& moving);

}  // namespace limber
