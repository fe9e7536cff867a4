// SPDX-License-Identifier: AGPL-3.0-or-later
// What is wrong with a tet mesh, and how good it is.
#pragma once

#include <map>
#include <string>

#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct MeshQuality {
  double min_dihedral_degrees = 0;
  double share_below_5_degrees = 0;  // of tets, by their smallest dihedral angle
  double covered = 0;                // share of tissue voxels whose centre lies in a tet
};

MeshQuality quality_of(const TetMesh& mesh, const Grid& grid, const TissueVoxels& tissue);

// mm3 of each region that has tets.
std::map<std::uint16_t, double> region_volumes(const TetMesh& mesh);
// mm3 that the triangles of each region enclose, air left out.    V  places of the surface's nodes, in the first rows
std::map<std::uint16_t, double> enclosed_volumes(const RegionSurface& surface, const Eigen::MatrixX3d& V);

// Empty when every tet is positive, the boundary is closed, no face has more than two tets, and each region has the
// volume that it should, to 1e-9 of the whole; else what is wrong.
std::string find_fault(const TetMesh& mesh, const std::map<std::uint16_t, double>& volumes);

}  // namespace limber
