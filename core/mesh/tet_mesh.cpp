// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/tet_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <Eigen/Geometry>

namespace limber {

namespace {

struct Face {
  int middle, high;  // the middle one and the largest of the face's three node indices
  int tet, face;
};

// The faces of all tets, grouped by their smallest node and sorted within each group, so that equal faces are adjacent.
struct FaceTable {
  std::vector<Face> faces;
  std::vector<int> first;  // #V + 1: index in `faces` of the first face of each smallest node's group
};

FaceTable table_of(const Eigen::MatrixX4i& T) {
  const int corners = T.size() > 0 ? T.maxCoeff() + 1 : 0;
  FaceTable table{std::vector<Face>(4 * T.rows()), std::vector<int>(corners + 1, 0)};
  const auto sorted = [&](int tet, int face) {
    std::array<int, 3> c;
    for (int i = 0; i < 3; ++i) c[i] = T(tet, kTetFaces[face][i]);
    std::sort(c.begin(), c.end());
    return c;
  };
  for (int tet = 0; tet < T.rows(); ++tet)
    for (int face = 0; face < 4; ++face) ++table.first[sorted(tet, face)[0] + 1];
  for (int c = 0; c < corners; ++c) table.first[c + 1] += table.first[c];
  std::vector<int> next(table.first.begin(), table.first.end());
  for (int tet = 0; tet < T.rows(); ++tet)
    for (int face = 0; face < 4; ++face) {
      const auto c = sorted(tet, face);
      table.faces[next[c[0]]++] = {c[1], c[2], tet, face};
    }
  for (int c = 0; c < corners; ++c)
    std::sort(table.faces.begin() + table.first[c], table.faces.begin() + table.first[c + 1],
              [](const Face& a, const Face& b) {
                return std::tie(a.middle, a.high, a.tet, a.face) < std::tie(b.middle, b.high, b.tet, b.face);
              });
  return table;
}

}  // namespace

std::vector<std::array<int, 4>> neighbours_of(const Eigen::MatrixX4i& T) {
  constexpr int kBoundary = -1, kCrowded = -2;
  std::vector<std::array<int, 4>> neighbours(T.rows(), {kBoundary, kBoundary, kBoundary, kBoundary});
  const FaceTable table = table_of(T);
  for (std::size_t corner = 0; corner + 1 < table.first.size(); ++corner)
    for (int i = table.first[corner], end = i; i < table.first[corner + 1]; i = end) {
      const Face& one = table.faces[i];
      while (end < table.first[corner + 1] && table.faces[end].middle == one.middle &&
             table.faces[end].high == one.high)
        ++end;
      if (end - i == 2) {
        const Face& other = table.faces[i + 1];
        neighbours[one.tet][one.face] = other.tet;
        neighbours[other.tet][other.face] = one.tet;
      } else if (end - i > 2) {
        for (int j = i; j < end; ++j) neighbours[table.faces[j].tet][table.faces[j].face] = kCrowded;
      }
    }
  return neighbours;
}

Eigen::MatrixX3i boundary_of(const Eigen::MatrixX4i& T) { return boundary_of(T, neighbours_of(T)); }

Eigen::MatrixX3i boundary_of(const Eigen::MatrixX4i& T, const std::vector<std::array<int, 4>>& neighbours) {
  Eigen::Index count = 0;
  for (const auto& of_tet : neighbours) count += std::count(of_tet.begin(), of_tet.end(), -1);
  Eigen::MatrixX3i F(count, 3);
  Eigen::Index row = 0;
  for (int tet = 0; tet < T.rows(); ++tet)
    for (int face = 0; face < 4; ++face)
      if (neighbours[tet][face] == -1) {
        for (int i = 0; i < 3; ++i) F(row, i) = T(tet, kTetFaces[face][i]);
        ++row;
      }
  return F;
}

std::vector<std::array<int, 4>> neighbours_of(const TetMesh& mesh) {
  if (mesh.copy_of.empty()) return neighbours_of(mesh.T);
  Eigen::MatrixX4i T = mesh.T;
  for (int& node : T.reshaped()) node = mesh.copy_of[node];
  return neighbours_of(T);
}

Eigen::MatrixX3i boundary_of(const TetMesh& mesh) { return boundary_of(mesh.T, neighbours_of(mesh)); }

double signed_volume(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet) {
  const Eigen::RowVector3d a = V.row(tet[0]), b = V.row(tet[1]) - a, c = V.row(tet[2]) - a, d = V.row(tet[3]) - a;
  return b.cross(c).dot(d) / 6;
}

double smallest_dihedral(const Eigen::MatrixX3d& V, const Eigen::RowVector4i& tet) {
  Eigen::RowVector3d normal[4];
  for (int face = 0; face < 4; ++face) {
    const Eigen::RowVector3d a = V.row(tet[kTetFaces[face][0]]);
    normal[face] = (V.row(tet[kTetFaces[face][1]]) - a).cross(V.row(tet[kTetFaces[face][2]]) - a);
  }
  double smallest = std::numbers::pi;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) {
      // The angle between outward normals is pi minus the angle between the faces.
      const double angle = std::atan2(normal[i].cross(normal[j]).norm(), -normal[i].dot(normal[j]));
      smallest = std::min(smallest, angle);
    }
  return smallest;
}

}  // namespace limber
