// SPDX-License-Identifier: AGPL-3.0-or-later
// A body's tissue as tetrahedra: a surface net fitted to the voxels, filled by TetGen, its flat tets improved, and all of it
// checked. Where TetGen fails on it, the plain net, which is coarser but as regular as can be; where it fails again, a split
// of lattice cells that cannot fail. Which of them it is, and why, is part of the answer, to be said to the user.
#pragma once

#include <string>

#include "core/base/progress.h"
#include "core/mesh/mesh_quality.h"

namespace limber {

enum class MeshMethod { fitted, plain, split };

struct MeshSettings {
  double spacing_mm = 8;
  std::vector<glm::dvec3> fine_around;  // world, mm: joints that bend; nodes are half as far apart there (not by `split`)
  double fine_radius_mm = 40;
  TetrahedralizeLimits limits = {};     // of TetGen, for each of its two attempts
};

struct TissueMesh {
  TetMesh mesh;            // no tets for a body without voxels
  MeshMethod method = MeshMethod::fitted;
  std::string warning;     // for the user, when the method is another: which and why; else empty
  MeshQuality quality;
  double spacing_mm = 0;   // as it became
  double seconds = 0;
};

// The same for any number of threads.
//   throws Cancelled
TissueMesh mesh_tissue(const VoxelRegions& voxels, const MeshSettings& settings = {}, Progress& progress = no_progress());

// Of a volume whose labels are regions: 0 not to be meshed, 1 soft tissue, 2 + bone.
TissueMesh mesh_tissue(const LabelVolume& regions, const MeshSettings& settings = {}, Progress& progress = no_progress());

}  // namespace limber
