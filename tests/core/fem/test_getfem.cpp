// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the energy of flesh with that of an independent program: GetFEM integrates the same formula, given as text.
#include <random>

#include <doctest/doctest.h>

#include "core/fem/fem_energy.h"
#include "tests/support/bent_arm.h"
#include "tests/support/fem_models.h"
#include "tests/support/getfem.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {

void compare_energies(const test::Flesh& flesh) {
  REQUIRE(count_inverted(flesh.T, flesh.moved) == 0);
  FemEnergy energy(flesh.rest, flesh.T, flesh.material, flesh.weak_barrier_kpa);
  NodePositions forces;
  energy.gradient(flesh.moved, forces);
  const double ours = energy.value(flesh.moved);
  const test::GetfemAnswer theirs = test::ask_getfem(flesh);
  MESSAGE("energy of ", flesh.T.rows(), " tets: ", ours, ", GetFEM differs by ", std::abs(ours - theirs.energy) / ours,
          ", in the forces by ", (forces - theirs.forces).norm() / forces.norm());
  CHECK(theirs.energy > 0);
  CHECK(std::abs(ours - theirs.energy) < 1e-10 * ours);
  CHECK((forces - theirs.forces).norm() < 1e-10 * forces.norm());
}

}  // namespace

#define NEEDS_GETFEM()                                                            \
  if (!test::has_getfem()) {                                                      \
    MESSAGE("SKIPPED: /usr/bin/python3 has no getfem (Debian's python3-getfem)"); \
    return;                                                                       \
  }

TEST_CASE(
    "elastic form: GetFEM finds the same energy and forces to ten digits, patches and barrier too, where it is "
    "installed") {
  NEEDS_GETFEM();
  const BarModel bar;
  const TetMesh& mesh = bar.fem.mesh;
  test::Flesh flesh{.rest = mesh.V, .T = mesh.T, .weak_barrier_kpa = 100};
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    flesh.material.push_back({1.0 + t / 500, t % 5 == 0 ? 0.3 : 0.499, 0.4 + 0.1 * double(t % 7)});
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  flesh.moved = flesh.rest + NodePositions::NullaryExpr(flesh.rest.rows(), 3, [&] { return uniform(random); });
  compare_energies(flesh);
}

TEST_CASE(
    "elastic form: GetFEM finds the same energy and forces to ten digits on the mesh of a real arm with a bent elbow") {
  NEEDS_GETFEM();
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  test::BentArm arm(test::shared_path("data/bender/man-arm-2mm.mha").string(),
                    test::shared_path("data/bender/man-arm-2mm-armature.vtk").string());
  arm.bend(45);
  const auto shape = arm.solved({.contact = true});
  REQUIRE(shape->solve.converged);
  const FemModel& model = shape->model.fem;
  compare_energies({.rest = model.mesh.V,
                    .moved = shape->V,
                    .T = model.mesh.T,
                    .material = model.material,
                    .weak_barrier_kpa = 100});
}
