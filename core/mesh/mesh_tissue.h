// SPDX-License-Identifier: AGPL-3.0-or-later
// Meshes a body's tissue with tetrahedra: fits a surface net to the voxels, fills it with the lattice's own tets,
// improves the flat ones, and checks the result. Filling with the lattice's tets needs no library and cannot fail.
// TetGen can fill the same net instead; if TetGen fails, the result contains the lattice's tets and a warning for the
// user.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"
#include "core/mesh/tetrahedralize.h"

namespace limber {

enum class Mesher { lattice, tetgen };

struct MeshSettings {
  // Mesher::lattice: the edge of a cube that contains one node on average; deep inside, nodes are sparser.
  // Mesher::tetgen: the distance between the samples from which the surface is built.
  double spacing_mm = 8;
  Mesher mesher = Mesher::lattice;
  // Positions of joints that bend, world, mm; nodes near them are half as far apart.
  std::vector<glm::dvec3> fine_around;
  double fine_radius_mm = 40;
  // Places near which bones must stay below the surface (LatticeNetSettings::Covered).
  std::vector<LatticeNetSettings::Covered> covered = {};
  TetrahedralizeLimits limits = {};  // limits on TetGen's time and memory
};

struct TissueMesh {
  TetMesh mesh;                     // the mesh; it has no tets if the body has no voxels
  Mesher mesher = Mesher::lattice;  // the mesher that made the mesh
  std::string warning;              // message for the user: what is not as requested; empty if nothing
  double spacing_mm = 0;            // the spacing in use, which may be larger than requested
  double seconds = 0;
};

// Returns the mesh, which does not depend on the number of threads.
//   throws Cancelled; Error if the mesh of the lattice's tets does not pass its check
TissueMesh mesh_tissue(const VoxelRegions& voxels, const MeshSettings& settings = {},
                       Progress& progress = no_progress());

// Meshes a volume whose labels are regions: 0 is not meshed, 1 is soft tissue, 2 + i is bone i. With `sides`, soft
// tissue on side s has the label 1 + soft_region(s), and the mesh is cut open along the seams: the two sides get nodes
// of their own, with a narrow gap between them.
TissueMesh mesh_tissue(const LabelVolume& regions, const MeshSettings& settings = {},
                       Progress& progress = no_progress(), const SeamSides& sides = {});

}  // namespace limber
