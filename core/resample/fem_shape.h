// SPDX-License-Identifier: AGPL-3.0-or-later
// Mesh, solve, and what became of them: the steps of resample.h by finite elements, before any voxel is written.
#pragma once

#include "core/fem/tissue_model.h"
#include "core/pose/pose.h"
#include "core/resample/fem.h"

namespace limber {

struct FemShape {
  TissueModel model;
  Eigen::MatrixX3d V;    // #V posed nodes, world, mm
  MovingTissue moving;
  double reached = 1;    // of the way from rest to the pose
  MeshReport mesh;
  SolveReport solve;
  double seconds_mesh = 0, seconds_solve = 0;
  FemSeconds cpu;        // of the solve
};

// The tissue that the pose bends, solved. None where the pose bends nothing.
//   weights  bone tissue follows one bone wholly
//   throws Error when the tissue cannot be meshed or memory does not suffice
std::shared_ptr<const FemShape> solve_shape(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues, const LabelSet& is_bone,
                                            const SkinWeights& weights, const Armature& armature, const Pose& pose, const Fem& fem,
                                            Progress& progress = no_progress());

}  // namespace limber
