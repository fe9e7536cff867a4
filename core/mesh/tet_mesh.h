// SPDX-License-Identifier: AGPL-3.0-or-later
// Tissue as a mesh of tetrahedra. Positions are world coordinates in mm. Every tet is positively oriented at rest:
// det(b - a, c - a, d - a) of its corners a, b, c, d is positive.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace limber {

struct TetMesh {
  static constexpr std::uint16_t kSoft = 0;

  Eigen::MatrixX3d V;                 // #V positions, world, mm
  Eigen::MatrixX4i T;                 // #T tets (four nodes each)
  std::vector<std::uint16_t> region;  // #T: kSoft, or 1 + the index of the rig bone to which the tet belongs
  // Where soft tissue may slide along a bone, the tets of the tissue and those of the bone have separate nodes at the
  // same positions at rest. #V: for such a node of the tissue, the node of the bone; for any other node, the node
  // itself. Empty: the mesh has no such nodes.
  std::vector<int> copy_of;
  // #T: on which side of seams the tet lies; empty if the mesh is not cut along seams. Where tets of two sides touch
  // at rest, each side may have separate nodes.
  std::vector<std::uint16_t> side;

  static int bone_of(std::uint16_t region) { return int(region) - 1; }  // -1: soft tissue
};

// The corners of a tet's faces. Face i is opposite to corner i; its corners are counter-clockwise seen from outside the
// tet.
inline constexpr int kTetFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// Returns, for each tet and face, the index of the tet on the other side of the face, #T by 4. -1: the face is on the
// boundary; -2: three or more tets share the face.
std::vector<std::array<int, 4>> neighbours_of(const Eigen::MatrixX4i& T);

// Returns the boundary: the faces that belong to only one tet, #F by 3 nodes, counter-clockwise seen from outside, in
// order of tet and face.
Eigen::MatrixX3i boundary_of(const Eigen::MatrixX4i& T);
Eigen::MatrixX3i boundary_of(const Eigen::MatrixX4i& T, const std::vector<std::array<int, 4>>& neighbours);

// Does the same as the function above for a mesh whose soft tissue may slide along bones. Two tets that touch at rest
// count as neighbours even if they have separate nodes there (TetMesh::copy_of). So the surface between bone and
// sliding tissue is no boundary.
std::vector<std::array<int, 4>> neighbours_of(const TetMesh& mesh);
Eigen::MatrixX3i boundary_of(const TetMesh& mesh);

double signed_volume(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet);      // returns mm3
double smallest_dihedral(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet);  // returns radians

}  // namespace limber
