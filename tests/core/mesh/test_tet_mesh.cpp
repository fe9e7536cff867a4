// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/tet_mesh.h"

#include <numbers>

#include <doctest/doctest.h>
#include <Eigen/Geometry>

using namespace limber;

namespace {

// A cube as six tets around its diagonal from corner 0 to corner 7 (corner i high in x if i & 1, and so on).
TetMesh cube() {
  TetMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i) mesh.V.row(i) << (i & 1), (i >> 1 & 1), (i >> 2);
  mesh.T.resize(6, 4);
  mesh.T << 0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7;
  mesh.region.assign(6, TetMesh::kSoft);
  return mesh;
}

}  // namespace

TEST_CASE("tet mesh: a cube of six tets has its volume, twelve faces outside and each tet two neighbours") {
  const TetMesh mesh = cube();
  double volume = 0;
  for (const auto& tet : mesh.T.rowwise()) volume += signed_volume(mesh.V, tet);
  CHECK(volume == doctest::Approx(1));
  const Eigen::MatrixX3i F = boundary_of(mesh.T);
  CHECK(F.rows() == 12);
  double flux = 0;  // flux of the position vector through the surface: three times the volume
  for (const auto& f : F.rowwise()) {
    const Eigen::RowVector3d a = mesh.V.row(f[0]), b = mesh.V.row(f[1]), c = mesh.V.row(f[2]);
    flux += (b - a).cross(c - a).dot(a + b + c) / 6;
  }
  CHECK(flux == doctest::Approx(3));
  const auto neighbours = neighbours_of(mesh.T);
  for (int tet = 0; tet < 6; ++tet) {
    CHECK(std::count(neighbours[tet].begin(), neighbours[tet].end(), -1) == 2);
    CHECK(std::count(neighbours[tet].begin(), neighbours[tet].end(), (tet + 1) % 6) == 1);
    CHECK(std::count(neighbours[tet].begin(), neighbours[tet].end(), (tet + 5) % 6) == 1);
  }
}

TEST_CASE("tet mesh: a face that three tets have is told, no tets have no boundary") {
  Eigen::MatrixX4i T(3, 4);
  T << 0, 1, 2, 3, 1, 0, 2, 4, 0, 1, 2, 5;
  CHECK(neighbours_of(T)[0][3] == -2);
  CHECK(boundary_of(T).rows() == 9);
  CHECK(boundary_of(Eigen::MatrixX4i(0, 4)).rows() == 0);
}

TEST_CASE("tet mesh: the smallest angle between faces of a corner of a cube and of a regular tet is the known one") {
  Eigen::MatrixX3d V(4, 3);
  V << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  CHECK(smallest_dihedral(V, {0, 1, 2, 3}) == doctest::Approx(std::acos(1 / std::sqrt(3.0))));
  V << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  CHECK(smallest_dihedral(V, {0, 1, 2, 3}) == doctest::Approx(std::acos(1 / 3.0)));
  V.row(3) << 1, 1.0, 1 - 1e-9;
  CHECK(smallest_dihedral(V, {0, 1, 2, 3}) < 1e-8);
}
