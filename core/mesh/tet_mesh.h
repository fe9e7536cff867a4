// SPDX-License-Identifier: AGPL-3.0-or-later
// Tissue as tetrahedra. Places are world coordinates in mm; every tet is positively oriented: (b - a, c - a, d - a) of
// its corners a, b, c, d has a positive determinant, at rest.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace limber {

struct TetMesh {
  static constexpr std::uint16_t kSoft = 0;

  Eigen::MatrixX3d V;                 // #V places, world, mm
  Eigen::MatrixX4i T;                 // #T corners
  std::vector<std::uint16_t> region;  // #T: kSoft, or 1 + the rig bone whose bone tissue the tet is

  static int bone_of(std::uint16_t region) { return int(region) - 1; }  // -1 of soft tissue
};

// Corners of a tet's faces: face i lies opposite to corner i, counter-clockwise seen from outside the tet.
inline constexpr int kTetFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// #T by 4: the tet on the other side of each face, -1 at the boundary. Where three or more tets share a face, -2.
std::vector<std::array<int, 4>> neighbours_of(const Eigen::MatrixX4i& T);

// #F by 3: the faces that only one tet has, counter-clockwise seen from outside, in order of tet and face.
Eigen::MatrixX3i boundary_of(const Eigen::MatrixX4i& T);
Eigen::MatrixX3i boundary_of(const Eigen::MatrixX4i& T, const std::vector<std::array<int, 4>>& neighbours);

double signed_volume(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet);      // mm3
double smallest_dihedral(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet);  // radians

}  // namespace limber
