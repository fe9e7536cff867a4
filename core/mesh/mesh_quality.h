// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures the quality of a tet mesh, and checks the mesh for faults.
#pragma once

#include <map>
#include <string>

#include "core/mesh/lattice_net.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

struct MeshQuality {
  double min_dihedral_degrees = 0;
  double share_below_5_degrees = 0;  // share of the tets whose smallest dihedral angle is below 5 degrees
  double covered = 0;                // share of tissue voxels whose centre is in a tet
  double near = 0;                   // share of tissue voxels that are covered or within kNearVoxels of a covered one
  double volume_ratio = 0;           // volume of the tets relative to that of the tissue voxels
};

MeshQuality quality_of(const TetMesh& mesh, const Grid& grid, const TissueVoxels& tissue);

// Returns the volume in mm3 of each region that has tets.
std::map<std::uint16_t, double> region_volumes(const TetMesh& mesh);
// Returns the volume in mm3 that the triangles of each region enclose; air has no entry.
//   V  node positions; the surface's nodes are its first rows
std::map<std::uint16_t, double> enclosed_volumes(const RegionSurface& surface, const Eigen::MatrixX3d& V);

// Returns a description of the first fault of the mesh, or an empty string. There is no fault if every tet is
// positively oriented, the boundary is closed, no face belongs to more than two tets, and each region has its expected
// volume, to within 1e-9 of the total volume.
std::string find_fault(const TetMesh& mesh, const std::map<std::uint16_t, double>& volumes);

}  // namespace limber
