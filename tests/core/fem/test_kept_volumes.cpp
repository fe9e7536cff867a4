// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/fem/kept_volumes.h"
#include "core/fem/step_bound.h"
#include "tests/support/fem_models.h"

using namespace limber;

namespace {

// Returns the tissue of the tets of a mesh for which is_in(centre) is true; it fills them whole.
template <class IsIn>
KeptVolume tissue_of(const TetMesh& mesh, double within, const IsIn& is_in) {
  KeptVolume kept{{}, within};
  for (int t = 0; t < mesh.T.rows(); ++t) {
    const Eigen::RowVector3d centre = mesh.V(mesh.T.row(t), Eigen::all).colwise().mean();
    if (is_in(centre)) kept.parts.push_back({t, signed_volume(mesh.V, mesh.T.row(t))});
  }
  return kept;
}

// Returns the change of a tissue's volume from rest to V, as a share, from the volumes of its tets alone.
double change_of(const TetMesh& mesh, const KeptVolume& kept, const Eigen::MatrixX3d& V) {
  double before = 0, after = 0;
  for (const KeptVolume::Part& part : kept.parts)
    before += signed_volume(mesh.V, mesh.T.row(part.tet)), after += signed_volume(V, mesh.T.row(part.tet));
  return after / before - 1;
}

}  // namespace

TEST_CASE("kept volumes: tissues of compressible flesh in a bend keep their volumes, and bones stay where they are") {
  BarModel bar(20, 6, 0.4);
  const TetMesh& mesh = bar.fem.mesh;
  const auto inner = tissue_of(mesh, 0.002, [](const auto& p) { return p[1] > 6 && std::abs(p[2]) < 20; });
  const auto outer = tissue_of(mesh, 0.02, [](const auto& p) { return p[1] < -6 && std::abs(p[2]) < 20; });
  REQUIRE(inner.parts.size() > 100);
  const SolvedPose loose = solve_pose(bar.fem, bar.bend(60), 60);
  REQUIRE(loose.converged);
  CHECK(std::abs(change_of(mesh, inner, loose.V)) > 0.01);
  CHECK(std::abs(change_of(mesh, outer, loose.V)) > 0.02);
  bar.fem.kept = {inner, outer};
  const SolvedPose kept = solve_pose(bar.fem, bar.bend(60), 60);
  CHECK(kept.converged);
  CHECK(kept.inverted == 0);
  CHECK(std::abs(change_of(mesh, inner, kept.V)) <= 0.002);
  CHECK(std::abs(change_of(mesh, outer, kept.V)) <= 0.02);
  CHECK(kept.iterations < loose.iterations + 15);
  for (int v = 0; v < mesh.V.rows(); ++v)
    if (bar.fem.held_by[v] == 0) CHECK((kept.V.row(v) - mesh.V.row(v)).norm() < 0.05);
  MESSAGE("iterations: " << loose.iterations << " without, " << kept.iterations << " with kept volumes");
}

TEST_CASE("kept volumes: the result does not depend on tissues that keep their volumes by themselves") {
  BarModel bar(12, 4);
  const SolvedPose free = solve_pose(bar.fem, bar.bend(20), 20);
  bar.fem.kept = {tissue_of(bar.fem.mesh, 0.02, [](const auto& p) { return p[0] > 0; })};
  CHECK(solve_pose(bar.fem, bar.bend(20), 20).V == free.V);
}

TEST_CASE("kept volumes: the forces of pressures are the slope of their energy") {
  const TetMesh mesh = kuhn_box(3, 3, 3, {0, 0, 0}, {9, 9, 9});
  const NodePositions rest = mesh.V;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  FemEnergy energy(rest, mesh.T, std::vector<TetMaterial>(mesh.T.rows(), {2, 0.49}), 0);
  std::vector<double> pressure(mesh.T.rows());
  std::vector<Eigen::Index> tet(mesh.T.rows());
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) pressure[t] = any(random), tet[t] = t;
  energy.set_pressures(pressure, tet);
  NodePositions x = rest;
  for (double& each : x.reshaped()) each += 0.2 * any(random);
  REQUIRE(count_inverted(mesh.T, x) == 0);
  NodePositions gradient;
  energy.gradient(x, gradient);
  constexpr double kStep = 1e-5;
  for (int v = 0; v < rest.rows(); v += 5)
    for (int axis = 0; axis < 3; ++axis) {
      NodePositions ahead = x, behind = x;
      ahead(v, axis) += kStep;
      behind(v, axis) -= kStep;
      const double slope = (energy.value(ahead) - energy.value(behind)) / (2 * kStep);
      CHECK(gradient(v, axis) == doctest::Approx(slope).epsilon(1e-5));
    }
}

TEST_CASE("kept volumes: what grew is pressed, what shrank is drawn out, and what is kept is left alone") {
  const TetMesh mesh = kuhn_box(4, 2, 2, {0, 0, 0}, {8, 4, 4});
  const std::vector<TetMaterial> material(mesh.T.rows(), {2, 0.49});
  const std::vector<KeptVolume> kept{tissue_of(mesh, 0.01, [](const auto& p) { return p[0] < 2; }),
                                     tissue_of(mesh, 0.01, [](const auto& p) { return p[0] > 6; })};
  VolumeKeeper keeper(mesh, kept, material);
  NodePositions x = mesh.V;
  CHECK(keeper.worst_at(x) == doctest::Approx(0));
  CHECK(keeper.pressures_at(x).empty());
  for (int v = 0; v < x.rows(); ++v) x(v, 0) += x(v, 0) < 1 ? -0.1 : x(v, 0) > 7 ? -0.2 : 0.0;
  CHECK(keeper.worst_at(x) == doctest::Approx(10));  // -10 %, of 1 %
  const std::vector<double> pressures = keeper.pressures_at(x);
  REQUIRE(std::ssize(pressures) == mesh.T.rows());
  for (const auto& part : kept[0].parts) CHECK(pressures[part.tet] > 0);
  for (const auto& part : kept[1].parts) CHECK(pressures[part.tet] < 0);
}

TEST_CASE("kept volumes: tets that the mesh does not have are refused") {
  BarModel bar(4, 2);
  bar.fem.kept = {{{{int(bar.fem.mesh.T.rows()), 1.0}}, 0.01}};
  CHECK_THROWS_AS(solve_pose(bar.fem, bar.bend(10), 10), Error);
}
