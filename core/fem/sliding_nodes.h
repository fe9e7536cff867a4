// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where flesh slides over bone, and lets it: near joints that the pose bends, skin, fat and other loose tissue
// slide along the bone below them. Muscles, tendons, ligaments, cartilage and nails grow onto bone, so they stick to
// it, and so does all tissue far from bent joints and all tissue between two bones.
//
// Flesh and bone share nodes in the mesh. Where flesh slides, the tets of flesh get nodes of their own, at the same
// places (TetMesh::copy_of); the bone keeps the others and stays rigid. Nodes of the two sides stay together by the
// distance from the bone's surface as meshed (slide_form.h), not by the voxels, so that no tet of flesh enters a tet of
// bone by more than the difference between the surface and its triangles.
#pragma once

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/fem/solve_pose.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SlidingSettings {
  struct Near {
    glm::dvec3 joint;  // a joint that the pose bends, world, mm
    double mm;         // tissue up to this distance from the joint slides, mm
  };
  std::vector<Near> near;  // empty: all tissue sticks
  double tet_mm = 8;       // edge length of the tets
  // Motions of the rig's bones at some positions on the path. Another bone within `joint_mm` in front of the surface at
  // rest, or within `closing_mm` in one of these motions, keeps the tissue between the two bones from sliding.
  std::vector<std::vector<RigidTransform>> motions = {};
  double joint_mm = 12, closing_mm = 8;
};

// Returns 1 for each node of bone over which soft tissue slides. No node of the mesh's boundary is among them.
//   bone  #V: the bone of each node; below 0 for nodes of soft tissue and for nodes of several bones
std::vector<std::uint8_t> sliding_nodes(const LabelVolume& volume, const TissueTable& tissues, const TetMesh& mesh,
                                        const std::vector<int>& bone, const SlidingSettings& settings);

// Gives the tets of soft tissue their own copies of the sliding nodes, which come after all other nodes, and computes
// the distance fields of the bones' surfaces there.
//   model   held_by and influences of its nodes must be set
//   slides  #V: 1 for the nodes that sliding_nodes() found, else 0
void let_slide(FemModel& model, const std::vector<std::uint8_t>& slides, double tet_mm);

}  // namespace limber
