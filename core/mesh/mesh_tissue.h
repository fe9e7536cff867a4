// SPDX-License-Identifier: AGPL-3.0-or-later
// A body's tissue as tetrahedra: a surface net fitted to the voxels with the lattice's own tets inside it, the flat
// ones improved, and all of it checked. That needs no library and cannot fail. TetGen may fill the same net instead;
// where it fails, the lattice's tets stand, and that is part of the answer, to be said to the user.
#pragma once

#include <string>

#include "core/base/progress.h"
#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"
#include "core/mesh/tetrahedralize.h"

namespace limber {

enum class Mesher { lattice, tetgen };

struct MeshSettings {
  double spacing_mm =
      8;  // of nodes, but deep inside: one for each cube of this side, by the lattice; of the net's samples for TetGen
  Mesher mesher = Mesher::lattice;
  std::vector<glm::dvec3> fine_around;  // world, mm: joints that bend; nodes are half as far apart there
  double fine_radius_mm = 40;
  TetrahedralizeLimits limits = {};  // of TetGen
};

struct TissueMesh {
  TetMesh mesh;                     // no tets for a body without voxels
  Mesher mesher = Mesher::lattice;  // that made it
  std::string warning;              // for the user, when it is not the one asked for: why; else empty
  double spacing_mm = 0;            // as it became
  double seconds = 0;
};

// The same for any number of threads.
//   throws Cancelled
TissueMesh mesh_tissue(const VoxelRegions& voxels, const MeshSettings& settings = {},
                       Progress& progress = no_progress());

// Of a volume whose labels are regions: 0 not to be meshed, 1 soft tissue, 2 + bone.
TissueMesh mesh_tissue(const LabelVolume& regions, const MeshSettings& settings = {},
                       Progress& progress = no_progress());

}  // namespace limber
