// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the cost of a Newton iteration with that of GetFEM with MUMPS on the mesh of a real arm, where
// python3-getfem is installed. Called as
//   limber_fem_getfem VOLUME RIG [SPACING_MM [DEGREES]]
// Both programs start from the arm bent by DEGREES, and compute the exact Newton step of flesh and springs, without
// contact, towards the pose that is bent by 7.5 degrees more. The two steps must be the same. Prints CPU seconds of one
// thread.
#include <cstdio>
#include <cstdlib>

#include "core/base/parallel.h"
#include "tests/support/bent_arm.h"
#include "tests/support/getfem.h"

namespace {
using namespace limber;

// Returns the part of the mesh that deforms, as solve_pose takes it: without the tets deep in a bone.
test::Flesh flesh_of(const FemModel& model, const Eigen::MatrixX3d& V, const std::vector<RigidTransform>& target) {
  const TetMesh& mesh = model.mesh;
  const auto holder = [&](Eigen::Index t) {
    const int bone = model.held_by[mesh.T(t, 0)];
    for (int i = 1; i < 4; ++i)
      if (model.held_by[mesh.T(t, i)] != bone) return -1;
    return bone;
  };
  std::vector<char> in_flesh(mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    if (holder(t) < 0)
      for (const int v : mesh.T.row(t)) in_flesh[v] = 1;

  test::Flesh flesh{.rest = mesh.V, .moved = V, .weak_barrier_kpa = 100};
  std::vector<Eigen::Index> elastic;
  std::vector<double> volume(mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    const auto corners = mesh.T.row(t);
    if (holder(t) >= 0 && std::none_of(corners.begin(), corners.end(), [&](int v) { return in_flesh[v]; })) continue;
    elastic.push_back(t);
    flesh.material.push_back(holder(t) >= 0 ? TetMaterial{100, 0.3} : model.material[t]);
    for (const int v : corners) volume[v] += signed_volume(mesh.V, corners) / 4;
  }
  flesh.T = mesh.T(elastic, Eigen::all);
  for (int v = 0; v < int(mesh.V.rows()); ++v)
    if (model.held_by[v] >= 0 && volume[v] > 0) flesh.pins.node.push_back(v);
  const auto pins = Eigen::Index(flesh.pins.node.size());
  flesh.pins.stiffness.resize(pins, 3), flesh.pins.target.resize(pins, 3);
  for (Eigen::Index k = 0; k < pins; ++k) {
    const int v = flesh.pins.node[k];
    const glm::dvec3 there = target[model.held_by[v]] * glm::dvec3(mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2));
    flesh.pins.stiffness.row(k).setConstant(1000 * volume[v]);
    flesh.pins.target.row(k) << there.x, there.y, there.z;
  }
  return flesh;
}
}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) {
    std::fprintf(stderr, "usage: limber_fem_getfem VOLUME RIG [SPACING_MM [DEGREES]]\n");
    return 2;
  }
  if (!test::has_getfem()) {
    std::printf("SKIPPED: /usr/bin/python3 has no getfem (Debian's python3-getfem)\n");
    return 0;
  }
  const double spacing = count > 3 ? std::atof(arguments[3]) : 8, degrees = count > 4 ? std::atof(arguments[4]) : 45;
  const ThreadCount one(1);
  test::BentArm arm(arguments[1], arguments[2]);
  arm.bend(degrees);
  const auto shape = arm.solved({.spacing_mm = spacing});
  const double whole = shape->cpu.total / shape->solve.iterations;
  const test::Flesh flesh = flesh_of(shape->model.fem, shape->V, arm.motions(1 + 7.5 / degrees));

  FemEnergy energy(flesh.rest, flesh.T, flesh.material, flesh.weak_barrier_kpa);
  energy.set_constraints(flesh.pins, {}, NodePositions(0, 3));
  NodePositions step;
  double slope = 0;
  const bool definite = energy.newton_step(flesh.moved, HessianKind::Exact, step, slope);
  const FemSeconds first = energy.seconds();
  energy.newton_step(flesh.moved, HessianKind::Projected, step, slope);
  const FemSeconds second = energy.seconds();
  const double ours = second.assembly - first.assembly + second.factorization - first.factorization;
  std::printf("h %g mm at %g degrees: %ld tets, %ld unknowns\n", spacing, degrees, long(flesh.T.rows()),
              3 * long(energy.matrix().node_count()));
  std::printf("limber: assembly %.2f s, factorization and solve %.2f s; an iteration of a solve, all told, %.2f s\n",
              second.assembly - first.assembly, second.factorization - first.factorization, whole);

  const test::GetfemAnswer theirs = test::ask_getfem(flesh, true);
  if (definite) {
    energy.newton_step(flesh.moved, HessianKind::Exact, step, slope);
    std::printf("the exact steps differ by %.1e\n", (step - theirs.step).norm() / step.norm());
  } else {
    std::printf("the exact curvature is indefinite here\n");
  }
  for (const char* which : {"patches", "tets"}) {
    const auto number = [&](const char* what) { return theirs.number.at(std::string(which) + what); };
    std::printf(
        "GetFEM, %s: %.0f unknowns, assembly %.2f s, MUMPS LU %.2f s, iteration with the symmetric MUMPS %.2f s: "
        "limber's step is %.1f times as fast, an iteration, all told, %.1f times (goal 3)\n",
        which[0] == 'p' ? "the same problem" : "tets without patches", number("_unknowns"), number("_assembly_seconds"),
        number("_lu_seconds"), number("_iteration_seconds"), number("_iteration_seconds") / ours,
        number("_iteration_seconds") / whole);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
