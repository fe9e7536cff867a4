// SPDX-License-Identifier: AGPL-3.0-or-later
// What of a body a pose bends. Tissue whose bones all move alike goes with them as a rigid body and needs no elements;
// so the cost of a pose follows what moves, not the size of the body.
//
// Tissue bends where its influences (or those of its neighbours) lie on bones that move differently. Elasticity carries
// further than weights do, so what lies within a margin of it may bend too, and so may what the pose brings near to
// another part of the body, where contact can press it in, with what is close around: from where on the way to the pose
// this can happen. Around that lies a rim that is meshed but held, on which the mesh meets what is not meshed. All of
// it is decided in cells of 4^3 voxels.
#pragma once

#include <array>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/inverse_map.h"
#include "core/fem/solve_pose.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct MovingSettings {
  double margin_mm = 30;  // around what bends by its weights
  double rim_mm = 20;     // held, around that
  bool contact = false;   // parts that the pose brings within `near_mm` of each other may bend, and what is within
                          // `give_mm` of them
  double near_mm = 16;
  double give_mm = 24;
  std::vector<double> places{0.25, 0.5, 0.75, 1};  // of the path that are looked at
};

struct DeformingRegion {
  std::vector<int> moves_as;  // per bone of the weights: the first bone that moves as it does, all along the path
  TissueMask free;            // may bend
  std::vector<std::array<float, 8>>
      free_from;      // per brick and its cells, along x, then y, then z: the place on the path before which
                      // they move as a rigid body; infinite where they always do
  TissueMask meshed;  // free, and the rim around it

  bool empty() const;                                                             // nothing bends
  float free_from_at(const TissueVoxels& tissue, const glm::ivec3& voxel) const;  // of a voxel of tissue
};

//   weights  bone tissue follows one bone wholly       path  of the bones of the weights
DeformingRegion moving_tissue(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                              const BonePath& path, const MovingSettings& settings = {},
                              Progress& progress = no_progress());

// The weights of what is not free made whole: each voxel of it on the one bone that its motion is.
SkinWeights with_rigid_rest(const SkinWeights& weights, const TissueVoxels& tissue, const DeformingRegion& moving);

}  // namespace limber
