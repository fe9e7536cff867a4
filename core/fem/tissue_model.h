// SPDX-License-Identifier: AGPL-3.0-or-later
// A body's tissue as the model that solve_pose takes: what each tet is made of, which bone holds which node.
//
// Material. A tet of 4 to 12 mm holds many voxels, and skin is often one voxel thick: so a tet's moduli mu and lambda
// are the means over the soft voxels whose centres lie in it (by Young's modulus and Poisson ratio of the tissue table;
// the Poisson ratio itself would not do: a tenth of cartilage would take half of the resistance of flesh to losing
// volume). A tet without any voxel takes the nearest one's. No soft tissue counts as stiffer than `stiffest`: a tendon
// of 1 GPa is a cord that slides in its sheath and buckles; as a solid as thick as a tet it would be a strut from bone
// to bone, against which no joint can turn.
//
// Bones. Nodes of a bone's tets are held by it; nodes of what is meshed but does not bend (deforming_region.h) by the
// bone that tissue goes with. A node of two bones that move differently is held by none. Tets between two bones are the
// joint: soft and compressible, for there the mesh is far coarser than the gap and fluid that let a joint turn. Bones
// slide along each other by more than a tet, which no single layer of tets can follow: so the ends of bones that lie
// within `joint_mm` of another bone are part of the joint too and not held. What of them is bone is painted rigidly in
// the volume all the same.
#pragma once

#include <map>
#include <vector>

#include "core/fem/deforming_region.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct TissueModelSettings {
  double joint_mm = 12;
  TetMaterial joint{.shear_modulus = 1, .poisson_ratio = 0.3};   // kPa
  double stiffest = 360;                                         // shear modulus of soft tissue, kPa
  TetMaterial bone{.shear_modulus = 100, .poisson_ratio = 0.3};  // of tets that are held at every node
};

struct TissueModel {
  struct Part {
    Label label;
    double mm3;
  };
  FemModel fem;
  std::vector<std::int32_t> first;  // #T + 1: where a tet's parts begin
  std::vector<Part> parts;          // what of each tet which label fills
  std::vector<std::uint8_t> joint;  // #T: 1 between two bones
};

// What is to be meshed: 0 air or not in the mesh, 1 soft tissue, 2 + bone (as moves_as) bone tissue.
LabelVolume regions_to_mesh(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                            const SkinWeights& weights, const DeformingRegion& moving);

//   weights  bone tissue follows one bone wholly
//   mesh     of regions_to_mesh; its regions are 1 + bone, as moves_as
TissueModel tissue_model(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const SkinWeights& weights, const DeformingRegion& moving, TetMesh mesh,
                         const TissueModelSettings& settings = {});

// How much each label, with the tets it lies in, gained or lost; without the joint, which may.    V  #V posed nodes
std::map<Label, double> volume_change_percent(const TissueModel& model, const Eigen::MatrixX3d& V);

// det F of every tet.
std::vector<double> volume_ratios(const TetMesh& mesh, const Eigen::MatrixX3d& V);

}  // namespace limber
