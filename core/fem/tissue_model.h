// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the model for solve_pose() from a body's tissue: the material of each tet, and the bone that holds each node.
//
// Material. A tet of 4 to 12 mm contains many voxels, and skin is often one voxel thick. So a tet's moduli mu and
// lambda are the means over the soft tissue in it (from Young's modulus and Poisson ratio of the tissue table). A mean
// of the Poisson ratio itself would be wrong: 10 % of cartilage would halve the resistance of flesh to volume changes.
// A tet without soft tissue takes the material of the nearest soft voxel. The stiffness of soft tissue is limited to
// `stiffest`, because of tendons. A tendon of 1 GPa is a cord that slides in its sheath and buckles; as a solid that is
// as thick as a tet it would be a strut between two bones, and no joint could turn against it.
//
// Bones. A bone holds the nodes of its tets. Nodes of tissue that is meshed but does not bend (deforming_region.h) are
// held by the bone with which that tissue moves. A node shared by two bones that move differently is not held. Tets
// between two bones form the joint: they are soft and compressible, because the mesh is far coarser than the gap and
// the fluid that let a real joint turn. Bones slide along each other by more than a tet, which a single layer of tets
// cannot follow: so the ends of bones within `joint_mm` of another bone also belong to the joint and are not held. If
// the pose brings two bones closer together than `closing_mm`, or into each other, soft tissue could not become thin
// enough between them: the nodes of bone there are not held either, and their tets belong to the joint. All bone voxels
// still move rigidly in the posed volume.
#pragma once

#include <map>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/fem/deforming_region.h"
#include "core/fem/seam_sides.h"
#include "core/fem/sliding_nodes.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct TissueModelSettings {
  double joint_mm = 12;
  // Motions of the rig's bones at some positions on the path from the rest pose to the pose. Each entry is indexed like
  // weights.bones().
  std::vector<std::vector<RigidTransform>> motions = {};
  double closing_mm = 8;  // nodes of bone that are closer to another bone in one of the motions belong to a joint
  // Where loose tissue slides over bone. tissue_model() sets its motions and distances from the members above.
  SlidingSettings sliding = {};
  const VoxelSides* sides = nullptr;  // the sides of seams, if the mesh is cut along seams; null: it is not
  TetMaterial joint{.shear_modulus = 1, .poisson_ratio = 0.3};   // material of joints; shear modulus in kPa
  double stiffest = 360;                                         // stiffer soft tissue gets this shear modulus, kPa
  TetMaterial bone{.shear_modulus = 100, .poisson_ratio = 0.3};  // material of tets of bone; shear modulus in kPa
};

struct TissueModel {
  struct Part {
    Label label;
    double mm3;
  };
  FemModel fem;
  std::vector<std::int32_t> first;  // #T + 1: index in `parts` of the first entry of each tet
  std::vector<Part> parts;          // entries of all tets: a label and the volume that it fills, mm3
  std::vector<std::uint8_t> joint;  // #T: 1 for tets between two bones, which form a joint
};

// Returns the regions to mesh as labels: 0 for air and tissue that is not meshed, 1 for soft tissue, 2 + b for tissue
// of bone b. Bones with the same motion count as one bone: b is an entry of DeformingRegion::moves_as. Soft tissue on
// side s > 0 of seams gets the label 1 + soft_region(s) instead.
//   sides  the sides of seams (sides_of_seams()); without any, all tissue lies on side 0
LabelVolume regions_to_mesh(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                            const SkinWeights& weights, const DeformingRegion& moving, const VoxelSides& sides = {});

// Builds the model of the meshed tissue.
//   weights  each voxel of bone tissue must follow one bone with weight 1
//   mesh     mesh of the regions that regions_to_mesh() returns. Its tets of bone b have the region 1 + b, its tets of
//            soft tissue the region 0
TissueModel tissue_model(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const SkinWeights& weights, const DeformingRegion& moving, TetMesh mesh,
                         const TissueModelSettings& settings = {});

// Returns the change of each label's volume in percent, from the volume ratios of the tets that contain it. Tets of
// joints are left out, since their volume may change.
//   V  #V posed nodes
std::map<Label, double> volume_change_percent(const TissueModel& model, const Eigen::MatrixX3d& V);

// Returns det F (posed volume / volume at rest) of every tet.
std::vector<double> volume_ratios(const TetMesh& mesh, const Eigen::MatrixX3d& V);

}  // namespace limber
