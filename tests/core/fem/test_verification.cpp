// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares solved shapes with shapes whose stress is known analytically.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include "core/fem/newton.h"
#include "tests/support/tet_shapes.h"

using namespace limber;

namespace {
constexpr double kStiff = 1e7;  // stiffness of a spring that holds a node, kPa mm

// Makes springs that hold nodes at `hold(position)`. A NaN leaves that axis of the node free.
template <class Hold>
PinForm held(const NodePositions& rest, const Hold& hold) {
  std::vector<int> node;
  std::vector<Eigen::RowVector3d> target;
  for (int v = 0; v < int(rest.rows()); ++v) {
    const Eigen::RowVector3d t = hold(Eigen::RowVector3d(rest.row(v)));
    if (t.array().isNaN().all()) continue;
    node.push_back(v);
    target.push_back(t);
  }
  PinForm pins{node, NodePositions(node.size(), 3), NodePositions(node.size(), 3)};
  for (std::size_t k = 0; k < node.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      pins.stiffness(k, c) = std::isnan(target[k][c]) ? 0 : kStiff;
      pins.target(k, c) = std::isnan(target[k][c]) ? 0 : target[k][c];
    }
  return pins;
}

// Returns the forces that the springs apply to the nodes.
NodePositions pull(const PinForm& pins, const NodePositions& x) {
  NodePositions force = NodePositions::Zero(x.rows(), 3);
  pins.add_gradient(x, force);
  return -force;
}

constexpr double kFree = std::numeric_limits<double>::quiet_NaN();

// Returns the pressure that blows up a shell until the points of its inner surface lie at radius `a`: the work of the
// springs of that surface per gained volume of the meshed shell. The shear modulus is 1 kPa.
//   nu          Poisson's ratio
//   inner       radius of the inner surface at rest, mm
//   patch_size  number of tets that share a pressure
//   axial       true: a tube of constant length; false: an eighth of a sphere whose cut faces stay in their planes
double pressure_at(const TetMesh& mesh, double nu, double inner, double a, int patch_size, bool axial) {
  const NodePositions rest = mesh.V;
  FemEnergy energy(rest, mesh.T, std::vector<TetMaterial>(mesh.T.rows(), {1, nu}), 0, patch_size);
  NodePositions x = rest;
  PinForm pins;
  const auto radius = [&](const Eigen::RowVector3d& p) { return axial ? std::hypot(p[0], p[1]) : p.norm(); };
  const double steps = std::ceil((a / inner - 1) / 0.1);
  for (int k = 1; k <= steps; ++k) {
    const double scale = 1 + (a / inner - 1) * k / steps;
    pins = held(rest, [&](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
      const bool inside = radius(p) < inner * (1 + 1e-6);
      if (axial) return {inside ? scale * p[0] : kFree, inside ? scale * p[1] : kFree, p[2]};
      Eigen::RowVector3d target = inside ? Eigen::RowVector3d(scale * p) : Eigen::RowVector3d::Constant(kFree);
      for (int c = 0; c < 3; ++c)
        if (std::abs(p[c]) < 1e-9) target[c] = 0;
      return target;
    });
    energy.set_constraints(pins, {}, {});
    const NewtonResult solved = minimise(energy, x, {.tolerance_mm = 1e-8});
    REQUIRE(solved.converged);
  }
  const NodePositions force = pull(pins, x);
  double work = 0;  // work of the springs of the inner surface when `a` grows by one
  for (const int v : pins.node)
    if (radius(rest.row(v)) < inner * (1 + 1e-6))
      for (int c = 0; c < (axial ? 2 : 3); ++c) work += force(v, c) * rest(v, c) / inner;
  // A meshed surface of radius r encloses the volume `unit` r^n, with `unit` from the mesh's volume.
  double solid = 0;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    solid += determinant(rest, mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3)) / 6;
  double outer = 0;
  for (Eigen::Index v = 0; v < rest.rows(); ++v) outer = std::max(outer, radius(rest.row(v)));
  const double n = axial ? 2 : 3, unit = solid / (std::pow(outer, n) - std::pow(inner, n));
  return work / (n * unit * std::pow(a, n - 1));
}
}  // namespace

TEST_CASE("verification: a bar pulled out or pressed has the stress and the volume of the paper's table") {
  struct Row {
    double nu, stretch, stress, J;
  };
  for (const Row& row : {Row{.45, 1.5, 1.04069265, 1.03344155}, Row{.49, .7, -1.32332664, .99143005},
                         Row{.49, 1.5, 1.05259220, 1.00666755}, Row{.49, 2, 1.74749950, 1.01000198}}) {
    INFO("Poisson ratio ", row.nu, ", stretch ", row.stretch);
    const TetMesh mesh = kuhn_box(3, 3, 3, {0, 0, 0}, {1, 1, 1});
    const NodePositions rest = mesh.V;
    FemEnergy energy(rest, mesh.T, std::vector<TetMaterial>(mesh.T.rows(), {1, row.nu}), 5);
    NodePositions x = rest;
    PinForm pins = held(rest, [&](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
      return {p[0] == 0 ? 0 : kFree, p[1] == 0 ? 0 : kFree, p[2] == 0 ? 0 : p[2] == 1 ? row.stretch : kFree};
    });
    energy.set_constraints(pins, {}, {});
    REQUIRE(minimise(energy, x, {.tolerance_mm = 1e-12}).converged);
    const NodePositions force = pull(pins, x);
    double top = 0, volume = 0;
    for (const int v : pins.node)
      if (rest(v, 2) == 1) top += force(v, 2);
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
      volume += determinant(x, mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3)) / 6;
    CHECK(std::abs(top - row.stress) < 2e-6);
    CHECK(std::abs(volume - row.J) < 2e-6);
  }
}

TEST_CASE("verification: a patch of tets held by its skin in an affine shape takes it inside too") {
  const TetMesh mesh = kuhn_box(4, 4, 4, {0, 0, 0}, {1, 1, 1});
  NodePositions rest = mesh.V;
  for (Eigen::Index v = 0; v < rest.rows(); ++v)
    if ((rest.row(v).array() > 0).all() && (rest.row(v).array() < 1).all())
      for (int c = 0; c < 3; ++c) rest(v, c) += 0.05 * std::sin(double(7 * v + 3 * c));
  Eigen::Matrix3d A;
  A << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.2, 0.1, 1.05;
  for (const double nu : {0.3, 0.499}) {
    FemEnergy energy(rest, mesh.T, std::vector<TetMaterial>(mesh.T.rows(), {1, nu}), 5);
    const auto skin = [](const Eigen::RowVector3d& p) { return (p.array() == 0).any() || (p.array() == 1).any(); };
    PinForm pins = held(rest, [&](const Eigen::RowVector3d& p) {
      return skin(p) ? Eigen::RowVector3d(p * A.transpose()) : Eigen::RowVector3d::Constant(kFree);
    });
    energy.set_constraints(pins, {}, {});
    NodePositions x = rest;
    REQUIRE(minimise(energy, x, {.tolerance_mm = 1e-11, .iterations = 80}).converged);
    // The springs that hold the skin yield by the stress over their stiffness, so the shape is exact only up to that.
    CHECK((x - rest * A.transpose()).cwiseAbs().maxCoeff() < 1e-5);
  }
}

TEST_CASE("verification: blowing up a thick incompressible tube takes the pressure on paper, with patches" *
          doctest::test_suite("slow")) {
  const TetMesh mesh = thick_cylinder(1, 2, 0.1, 10, 80, 1);
  for (const auto& [a, pressure] : {std::pair{1.1, .131562}, {1.25, .275712}, {1.5, .428228}}) {
    INFO("inner radius ", a);
    const double with = pressure_at(mesh, .499, 1, a, 8, true);
    MESSAGE("tube, inner radius ", a, ": ", with, " with patches, ", pressure, " on paper");
    CHECK(with == doctest::Approx(pressure).epsilon(0.02));
  }
  const double without = pressure_at(mesh, .499, 1, 1.1, 1, true);
  MESSAGE("tube of plain tets, inner radius 1.1: ", without);
  CHECK(std::abs(without / .131562 - 1) > 2 * std::abs(pressure_at(mesh, .499, 1, 1.1, 8, true) / .131562 - 1));
}

TEST_CASE(
    "verification: blowing up a thick incompressible sphere takes the pressure on paper, with patches, plain tets "
    "lock" *
    doctest::test_suite("slow")) {
  const TetMesh mesh = thick_sphere_eighth(1, 2, 12, 8);
  for (const auto& [a, pressure] : {std::pair{1.1, .287155}, {1.25, .551869}, {1.5, .755433}}) {
    INFO("inner radius ", a);
    const double with = pressure_at(mesh, .499, 1, a, 8, false);
    MESSAGE("sphere, inner radius ", a, ": ", with, " with patches, ", pressure, " on paper");
    CHECK(with == doctest::Approx(pressure).epsilon(0.02));
  }
  const double without = pressure_at(mesh, .499, 1, 1.1, 1, false);
  MESSAGE("sphere of plain tets, inner radius 1.1: ", without);
  CHECK(std::abs(without / .287155 - 1) > 2 * std::abs(pressure_at(mesh, .499, 1, 1.1, 8, false) / .287155 - 1));
}
