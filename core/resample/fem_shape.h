// SPDX-License-Identifier: AGPL-3.0-or-later
// Mesh, solve, and what became of them: the steps of resample.h by finite elements, before any voxel is written.
#pragma once

#include <vector>

#include "core/fem/tissue_model.h"
#include "core/resample/fem.h"
#include "core/rig/pose.h"

namespace limber {

struct FemShape {
  TissueModel model;
  Eigen::MatrixX3d V;  // #V posed nodes, world, mm
  DeformingRegion moving;
  double reached = 1;  // of the way to the pose
  Pose pose;           // where that is
  MeshReport mesh;
  SolveReport solve;
  double seconds_mesh = 0, seconds_solve = 0;
  FemSeconds cpu;  // of the solve
};

// The tissue that the pose bends, solved. None where the pose bends nothing.
//   weights  bone tissue follows one bone wholly
//   throws Error when the tissue cannot be meshed or memory does not suffice
std::shared_ptr<const FemShape> solve_shape(const LabelVolume& volume, const TissueVoxels& tissue,
                                            const TissueTable& tissues, const LabelSet& is_bone,
                                            const SkinWeights& weights, const Armature& armature, const Pose& pose,
                                            const Fem& fem, Progress& progress = no_progress());

// The same for a run of poses, as the frames of a motion. They share one mesh, of all the tissue that any of them
// bends, and each is solved from where the one before it ended, the first from rest.
class FemSequence {
 public:
  // All but the settings must outlive it.
  FemSequence(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
              const LabelSet& is_bone, const SkinWeights& weights, const Armature& armature, std::vector<Pose> poses,
              Fem fem, Progress& progress = no_progress());

  // Of the next pose. None where nothing bends in any of them.
  std::shared_ptr<const FemShape> next(Progress& progress = no_progress());

 private:
  const SkinWeights& weights_;
  const Armature& armature_;
  const LabelSet& is_bone_;
  std::vector<Pose> poses_;
  Fem fem_;
  double spacing_, finest_;                 // mm
  std::vector<FemModel::Waiting> waiting_;  // on the way through all poses
  std::size_t solved_ = 0;
  FemShape last_;  // at rest, before the first
};

}  // namespace limber
