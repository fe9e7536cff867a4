// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/fem_measures.h"

#include <cmath>

#include <doctest/doctest.h>

#include "tests/support/kuhn_mesh.h"
#include "tests/support/tet_shapes.h"

using namespace limber;

namespace {

FemMesh flesh(TetMesh tets, const TetMaterial& material) {
  FemMesh mesh{std::move(tets), {}, {}};
  mesh.material.assign(mesh.tets.T.rows(), material);
  mesh.joint.assign(mesh.tets.T.rows(), 0);
  return mesh;
}

// Volume ratio and energy density of a box under x -> F x + t. They are the same in all tets.
struct Measured {
  double J, W;
};
Measured measured(const Eigen::Matrix3d& F, const TetMaterial& material) {
  const FemMesh mesh = flesh(kuhn_box(2, 3, 2, {-3, 1, 0}, {4, 5, 6}), material);
  const Eigen::MatrixX3d V = (mesh.tets.V * F.transpose()).rowwise() + Eigen::RowVector3d(3, -7, 11);
  const auto J = fem_measure(FemMeasure::VolumeRatio, mesh, V), W = fem_measure(FemMeasure::EnergyDensity, mesh, V);
  REQUIRE(std::ssize(J) == mesh.tets.T.rows());
  for (std::size_t t = 0; t < J.size(); ++t) {
    CHECK(J[t] == doctest::Approx(J[0]).epsilon(1e-6));
    CHECK((W[t] == W[0] || W[t] == doctest::Approx(W[0]).epsilon(1e-5)));  // both are infinite if tets are inverted
  }
  return {J[0], W[0]};
}

}  // namespace

TEST_CASE("fem measures: stretch, shear and turn have the volume ratio and the energy that paper and pencil give") {
  const TetMaterial fat{.shear_modulus = 2, .poisson_ratio = 0.3}, muscle{.shear_modulus = 5, .poisson_ratio = 0.499};
  const double lambda = 2 * 2 * 0.3 / (1 - 0.6);
  const Measured stretched = measured(Eigen::Vector3d(1.5, 1, 0.8).asDiagonal(), fat);
  CHECK(stretched.J == doctest::Approx(1.2));
  CHECK(stretched.W ==
        doctest::Approx(1.0 * (2.25 + 1 + 0.64 - 3) - 2 * std::log(1.2) + lambda / 2 * 0.04).epsilon(1e-5));
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = 0.7;
  const Measured sheared = measured(shear, muscle);
  CHECK(sheared.J == doctest::Approx(1));
  CHECK(sheared.W == doctest::Approx(0.5 * 5 * 0.49).epsilon(1e-5));  // independent of the Poisson ratio
  const Measured turned =
      measured(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(), muscle);
  CHECK(turned.J == doctest::Approx(1));
  CHECK(turned.W == doctest::Approx(0));
  const Measured inverted = measured(Eigen::Vector3d(1, 1, -1).asDiagonal(), fat);
  CHECK(inverted.J == doctest::Approx(-1));
  CHECK(std::isinf(inverted.W));
}

TEST_CASE("fem measures: tets between bones have none, and tissue outside the mesh is as at rest") {
  FemMesh mesh = flesh(kuhn_box(1, 1, 1, {0, 0, 0}, {1, 1, 1}), {});
  mesh.joint[2] = 1;
  for (const FemMeasure measure : {FemMeasure::VolumeRatio, FemMeasure::EnergyDensity, FemMeasure::Gap}) {
    const auto values = fem_measure(measure, mesh, mesh.tets.V);
    for (std::size_t t = 0; t < values.size(); ++t) CHECK(std::isnan(values[t]) == (t == 2));
    CHECK(values[0] == measure_at_rest(measure));
  }
}

TEST_CASE("fem measures: the gap is the air between skins that were apart at rest, and of no tet inside") {
  // Two boxes of 8 mm cubes are far apart at rest, and 1.5 mm apart in the pose.
  const TetMesh box = kuhn_box(3, 3, 3, {0, 0, 0}, {24, 24, 24});
  TetMesh two = box;
  two.V.resize(2 * box.V.rows(), 3);
  two.V << box.V, box.V.rowwise() + Eigen::RowVector3d(0, 0, 200);
  two.T.resize(2 * box.T.rows(), 4);
  two.T << box.T, box.T.array() + int(box.V.rows());
  two.region.assign(two.T.rows(), TetMesh::kSoft);
  const FemMesh mesh = flesh(two, {});
  Eigen::MatrixX3d V = two.V;
  V.bottomRows(box.V.rows()).col(2).array() += 24 + 1.5 - 200;
  const auto gap = fem_measure(FemMeasure::Gap, mesh, V);
  for (std::size_t t = 0; t < gap.size(); ++t) {
    bool faces_the_other = false;
    for (int i = 0; i < 4; ++i) faces_the_other |= std::abs(V(two.T(t, i), 2) - 24) < 2;
    if (faces_the_other) CHECK(gap[t] == doctest::Approx(1.5));
    else CHECK(std::isinf(gap[t]));
  }
  for (const float mm : fem_measure(FemMeasure::Gap, mesh, two.V)) CHECK(std::isinf(mm));
}

TEST_CASE("fem measures: each voxel lies in the tet whose corners are around it, in a mirrored grid too") {
  LabelVolume volume{.grid = {.size = {20, 18, 25}, .spacing = {2, 1.5, 1}, .origin = {-20, 4, 9}}, .voxels = {}};
  SUBCASE("as it is") {}
  SUBCASE("mirrored") { volume.grid.direction[2] = {0, 0, -1}; }
  volume.voxels.assign(volume.grid.voxel_count(), 1);
  volume.at({10, 9, 12}) = 0;
  const TissueVoxels tissue(volume);
  // The mesh fills a part of the volume and is bent.
  TetMesh mesh = test::kuhn_mesh(volume.grid, {3.2, 4.1, 5.3}, {15.7, 14.6, 20.2}, {3, 3, 4});
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) mesh.V(v, 0) += 0.01 * (mesh.V(v, 2) - 20) * (mesh.V(v, 2) - 20);
  const auto tets = tets_of_voxels(mesh.T, mesh.V, volume.grid, tissue);
  REQUIRE(std::ssize(tets) == tissue.size());
  const AffineTransform world = world_from_voxel(volume.grid);
  const auto smallest_share = [&](int t, const glm::ivec3& v) {
    const glm::dvec3 p = world * glm::dvec3(v);
    Eigen::Matrix4d corners;
    for (int i = 0; i < 4; ++i) corners.col(i) << mesh.V.row(mesh.T(t, i)).transpose(), 1;
    return corners.inverse().operator*(Eigen::Vector4d(p.x, p.y, p.z, 1)).minCoeff();
  };
  int inside = 0, beside = 0, outside = 0;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    double best = -1e9;
    for (int t = 0; t < mesh.T.rows(); ++t) best = std::max(best, smallest_share(t, v));
    if (best > 1e-9) {
      ++inside;
      CHECK(smallest_share(tets[place], v) > -1e-6);
    } else if (best < -1e-9) {
      ++(tets[place] < 0 ? outside : beside);
    }
  });
  CHECK(inside > 1000);
  CHECK(beside > 100);
  CHECK(outside > 1000);
  CHECK(tets[tissue.index_of({0, 0, 0})] == -1);
}
