// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes a whole labelled body with tetrahedra: one mesh in which neighbouring tissues share their nodes, bones and
// organs included, as in the mesh-type reference phantoms [ICRP Publication 145, 2020].
//
// The mesh is that of a surface net over the voxels (surface_net.h), so it cannot fail and every tet is positively
// oriented. The surfaces between tissues are smoothed. Then the net's nodes are moved so that each tissue gets the
// volume of its voxels, with the smallest sum of squared movements (Newton's method on the volumes). Deep inside a
// tissue tets are larger. Where a seam separates tissue that touches, the mesh has two surfaces with separate nodes at
// the same positions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/tet_mesh.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct BodyMeshSettings {
  int relaxations = 4;  // steps of smoothing; 0: the surfaces are the faces of the voxels
  // Wanted volume of each label, mm3, by label; after resampling to other voxels, pass the volumes before the
  // resampling. Empty: each label gets the volume of its voxels.
  std::vector<double> volumes = {};
};

struct BodyMesh {
  TetMesh mesh;  // world, mm; the region of a tet is its label
  // For each tet the corner (0 to 3) that is the centre of a voxel of its label.
  std::vector<std::uint8_t> voxel_corner;
  std::vector<int> at_seam;  // the nodes on seams; the tets around each node lie on one side of the seam
  // Largest difference between the volume of a label's tets and the volume asked for, as a share of the latter.
  double largest_volume_error = 0;
  std::uint16_t worst_label = 0;  // the label with this difference
};

// Upper limit on the samples of the lattice: the voxels of the box around the tissue. The caller must first resample a
// larger body to fewer voxels.
constexpr std::int64_t kMostMeshSamples = 60'000'000;

// Returns the mesh, which does not depend on the number of threads.
//   tissue  the tissue voxels of `volume`, with their seams
//   throws Cancelled; Error if the volume has no tissue, or more than kMostMeshSamples voxels in the box around it
BodyMesh mesh_body(const LabelVolume& volume, const TissueVoxels& tissue, const BodyMeshSettings& settings = {},
                   Progress& progress = no_progress());

}  // namespace limber
