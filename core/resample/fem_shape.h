// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes the tissue that a pose bends and solves for the mesh's posed shape. The posed voxels are written afterwards
// (resample.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/fem/tissue_model.h"
#include "core/resample/fem.h"
#include "core/rig/pose.h"

namespace limber {

// A solved mesh with its reports.
struct FemShape {
  TissueModel model;
  Eigen::MatrixX3d V;  // #V posed nodes, world, mm
  DeformingRegion moving;
  std::shared_ptr<const VoxelSides> sides;  // the sides of seams along which the mesh is cut; null: it is not cut
  double reached = 1;                       // share of the way to the pose that was reached, [0, 1]
  Pose pose;                                // the pose that was reached
  MeshReport mesh;
  SolveReport solve;
  double seconds_mesh = 0, seconds_solve = 0;
  FemSeconds cpu;  // CPU time of each stage of the solve
  std::vector<ObjectReport> objects;
  std::vector<PressedNode> pressed;  // the nodes of the skin that objects press
};

// Returns the solved shape of the tissue that the pose bends; null: the pose bends nothing.
//   weights  rigid in bone tissue: each bone voxel follows one rig bone alone
//   throws Error when the tissue cannot be meshed or memory does not suffice
std::shared_ptr<const FemShape> solve_shape(const LabelVolume& volume, const TissueVoxels& tissue,
                                            const TissueTable& tissues, const LabelSet& is_bone,
                                            const SkinWeights& weights, const Armature& armature, const Pose& pose,
                                            const Fem& fem, Progress& progress = no_progress());

// Solves a sequence of poses, such as the frames of a motion. The poses share one mesh of all the tissue that any of
// them bends. The first solve starts from rest, each later one from the shape in which the solve before it ended.
class FemSequence {
 public:
  // Keeps references to `is_bone`, `weights` and `armature`, which must outlive the sequence.
  FemSequence(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
              const LabelSet& is_bone, const SkinWeights& weights, const Armature& armature, std::vector<Pose> poses,
              Fem fem, Progress& progress = no_progress());

  // Solves the next pose of the sequence and returns its shape; null: no pose of the sequence bends anything.
  std::shared_ptr<const FemShape> next(Progress& progress = no_progress());

 private:
  // Solves the pose of `shape` a second time, with larger tets, and returns the estimated error of `shape`.
  FemError error_of(const FemShape& shape, Progress& progress);

  const SkinWeights& weights_;
  const Armature& armature_;
  const LabelSet& is_bone_;
  std::vector<Pose> poses_;
  Fem fem_;
  double size_ = 1;  // thickness of the thinnest bent limb, relative to an adult's elbow (1)
  // The limb size for which the solver's lengths and stiffnesses are chosen. It is size_, or the larger size that suits
  // the tets if the tets are larger than the thinnest bent limb requires: with the contact distance and the tolerance
  // of a finger, tets of a thigh would need very many iterations.
  double solver_size_ = 1;
  double spacing_ = 0, finest_ = 0;  // edge length of the tets, and of the smallest tets around joints, mm
  double reach_ = 0;                 // width that scales the meshed region, mm (Fem::reach_mm)
  // Nodes that follow a bone until the path position `until`, [0, 1] over the whole path.
  std::vector<FemModel::Waiting> waiting_;
  std::size_t solved_ = 0;  // number of poses solved so far
  FemObjects objects_;
  double weight_n_ = 0;                  // weight of the body, N
  bool is_pressed_ = false;              // true: the objects have reached their target positions
  bool has_weight_ = false;              // true: gravity acts with full strength at the start of the next solve
  Grid grid_;                            // grid of the body's volume
  std::unique_ptr<FemSequence> coarse_;  // solves the same poses with larger tets; null: no error estimate
  std::string no_estimate_;              // why the error cannot be estimated
  FemShape last_;                        // the last solved shape; before the first solve the shape at rest
};

}  // namespace limber
