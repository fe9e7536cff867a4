// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/slide_form.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <doctest/doctest.h>
#include <Eigen/Dense>
#include <glm/gtc/quaternion.hpp>

#include "core/fem/newton.h"
#include "tests/support/tet_shapes.h"

using namespace limber;

namespace {

constexpr double kFree = std::numeric_limits<double>::quiet_NaN();

double from_ball(const Eigen::RowVector3d& p) { return p.norm() - 10; }

// A ball of bone that has turned and moved, with five nodes of flesh near its surface.
struct OnBall {
  SlideForm form;
  NodePositions x{5, 3};

  OnBall() {
    const Eigen::RowVector3d corner(20, 20, 20);
    form.surface = {nullptr, std::make_shared<const DistanceField>(-corner, corner, 0.5, from_ball)};
    form.posed_from_rest = {{}, {glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -1))), {3, -4, 5}}};
    std::mt19937 random(7);
    std::uniform_real_distribution<double> share(-1, 1);
    for (int v = 0; v < 5; ++v) {
      const Eigen::RowVector3d rest =
          10.3 * Eigen::RowVector3d(share(random), share(random), share(random)).normalized();
      form.nodes.push_back({v, 1, 40.0 + v, 0.5, rest, form.surface[1]->at(rest).mm});
      const glm::dvec3 there = form.posed_from_rest[1] * glm::dvec3(rest[0], rest[1], rest[2]);
      x.row(v) << there.x, there.y, there.z;
      x.row(v) += Eigen::RowVector3d(share(random), share(random), share(random));
    }
  }
};

// Returns springs that hold nodes. hold(place) gives the target of the node that rests at `place`; a NaN in it leaves
// that axis free.
template <class Hold>
PinForm held(const NodePositions& rest, const Hold& hold) {
  PinForm pins;
  std::vector<Eigen::RowVector3d> target;
  for (int v = 0; v < int(rest.rows()); ++v) {
    const Eigen::RowVector3d t = hold(Eigen::RowVector3d(rest.row(v)));
    if (t.array().isNaN().all()) continue;
    pins.node.push_back(v);
    target.push_back(t);
  }
  pins.stiffness = pins.target = NodePositions::Zero(pins.node.size(), 3);
  for (std::size_t k = 0; k < pins.node.size(); ++k)
    for (int c = 0; c < 3; ++c)
      if (!std::isnan(target[k][c])) pins.stiffness(k, c) = 1e7, pins.target(k, c) = target[k][c];
  return pins;
}

// A sleeve of flesh around a rod, like a limb's flesh around its bone. The sleeve's radius is twice that of the rod.
// The mesh has about `across` tets across the sleeve's diameter.
struct Sleeve {
  static constexpr double kInner = 20, kOuter = 40, kLength = 60;
  double shear = 10, poisson_ratio = 0.45;
  TetMesh mesh;
  NodePositions rest, x;

  explicit Sleeve(int across) {
    const double edge = 2 * kOuter / across;
    mesh = thick_cylinder(kInner, kOuter, kLength, int(std::lround((kOuter - kInner) / edge)),
                          int(std::lround(2 * M_PI * kOuter / edge)), int(std::lround(kLength / edge)));
    rest = mesh.V;
  }

  static double radius(const Eigen::RowVector3d& p) { return std::hypot(p[0], p[1]); }
  static bool is_inner(const Eigen::RowVector3d& p) { return radius(p) < kInner * (1 + 1e-6); }
  static bool is_outer(const Eigen::RowVector3d& p) { return radius(p) > kOuter * (1 - 1e-6); }

  // Sets x to the shape of least energy, in which the flesh slides on the rod. `fascia` is the stiffness against
  // sliding, kPa/mm.
  void solve(const PinForm& pins, double fascia) {
    FemEnergy energy(rest, mesh.T, std::vector<TetMaterial>(mesh.T.rows(), {shear, poisson_ratio}), 0);
    const Eigen::RowVector3d corner(1.5 * kInner, 1.5 * kInner, 0), along(0, 0, 1.5 * kLength);
    SlideForm slide;
    slide.surface = {std::make_shared<const DistanceField>(
        -corner - along, corner + along, 1, [](const Eigen::RowVector3d& p) { return radius(p) - kInner; })};
    slide.posed_from_rest = {{}};
    std::vector<double> mm2(rest.rows(), 0);
    const Eigen::MatrixX3i surface = boundary_of(mesh.T);
    for (const auto& f : surface.rowwise())
      if (is_inner(rest.row(f[0])) && is_inner(rest.row(f[1])) && is_inner(rest.row(f[2]))) {
        const Eigen::RowVector3d a = rest.row(f[1]) - rest.row(f[0]), b = rest.row(f[2]) - rest.row(f[0]);
        for (const int v : f) mm2[v] += a.cross(b).norm() / 6;
      }
    for (int v = 0; v < int(rest.rows()); ++v)
      if (mm2[v] > 0)
        slide.nodes.push_back({v, 0, 1e4 * mm2[v], fascia * mm2[v], rest.row(v), slide.surface[0]->at(rest.row(v)).mm});
    energy.set_slide(slide);
    energy.set_constraints(pins, {}, {});
    x = rest;
    REQUIRE(minimise(energy, x, {.tolerance_mm = 1e-8}).converged);
  }

  // Returns two errors of the nodes' motion: the largest difference from the exact motion, divided by the largest exact
  // motion; and the root mean square of the difference, divided by that of the exact motion.
  template <class Motion>
  std::pair<double, double> error_of(const Motion& exact) const {
    double worst = 0, largest = 0, squares = 0, all = 0;
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      const Eigen::RowVector3d wanted = exact(Eigen::RowVector3d(rest.row(v)));
      const double off = (x.row(v) - rest.row(v) - wanted).norm();
      worst = std::max(worst, off), largest = std::max(largest, wanted.norm());
      squares += off * off, all += wanted.squaredNorm();
    }
    return {worst / largest, std::sqrt(squares / all)};
  }

  // Stretches the sleeve along the rod by a small strain, with its outside free, and returns error_of(). In the exact
  // solution the strain along the rod is uniform, and points move radially by A r + B / r, as in a thick-walled tube
  // [Lame 1852], without motion at the inner wall and without stress on the outside.
  std::pair<double, double> pulled() {
    constexpr double kStrain = 1e-4;
    solve(held(rest,
               [](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
                 const bool end = p[2] < 1e-9 || p[2] > kLength - 1e-9;
                 // By symmetry, the nodes of the plane y = 0 stay in it. Holding them there keeps the sleeve from
                 // spinning.
                 return {kFree, std::abs(p[1]) < 1e-9 ? 0 : kFree, end ? p[2] + kStrain * (p[2] - kLength / 2) : kFree};
               }),
          0);
    const double lambda = lame_lambda(shear, poisson_ratio), ratio = kInner * kInner / (kOuter * kOuter);
    const double A = -lambda * kStrain / (2 * lambda + 2 * shear * (1 + ratio)), B = -A * kInner * kInner;
    return error_of([&](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
      const double r = radius(p), out = A + B / (r * r);
      return {out * p[0], out * p[1], kStrain * (p[2] - kLength / 2)};
    });
  }

  // Turns the sleeve's outside about the rod by a small angle, against the fascia, and returns error_of(). In the exact
  // solution, points move around the rod by C r + D / r [Love 1892], and the shear stress at the rod is the fascia's
  // stiffness times the distance that the flesh slides there.
  std::pair<double, double> twisted() {
    constexpr double kAngle = 1e-4, kFascia = 0.6;
    solve(held(rest,
               [](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
                 const double end = p[2] < 1e-9 || p[2] > kLength - 1e-9 ? p[2] : kFree;
                 if (!is_outer(p)) return {kFree, kFree, end};
                 return {p[0] - kAngle * p[1], p[1] + kAngle * p[0], end};
               }),
          kFascia);
    const double a = kInner, share = -kFascia * a * a * a / (2 * shear + kFascia * a);  // D / C
    const double C = kAngle / (1 + share / (kOuter * kOuter));
    return error_of([&](const Eigen::RowVector3d& p) -> Eigen::RowVector3d {
      const double r = radius(p), turn = C * (1 + share / (r * r));
      return {-turn * p[1], turn * p[0], 0};
    });
  }
};

}  // namespace

TEST_CASE("slide form: the force is the derivative of the energy, the Hessian that of the force") {
  OnBall ball;
  NodePositions force = NodePositions::Zero(5, 3);
  ball.form.add_gradient(ball.x, force);
  constexpr double kStep = 1e-5;
  for (int v = 0; v < 5; ++v) {
    const Eigen::Matrix3d H = ball.form.curvature_of(ball.form.nodes[v], ball.x, HessianKind::Exact);
    for (int c = 0; c < 3; ++c) {
      NodePositions more = ball.x, less = ball.x, force_more = force, force_less = force;
      more(v, c) += kStep, less(v, c) -= kStep;
      const double slope = (ball.form.value(more) - ball.form.value(less)) / (2 * kStep);
      CHECK(slope == doctest::Approx(force(v, c)).epsilon(1e-6));
      force_more.setZero(), force_less.setZero();
      ball.form.add_gradient(more, force_more);
      ball.form.add_gradient(less, force_less);
      const Eigen::RowVector3d change = (force_more.row(v) - force_less.row(v)) / (2 * kStep);
      CHECK((change - H.row(c)).norm() < 1e-5 * H.norm());
    }
    const Eigen::Matrix3d projected = ball.form.curvature_of(ball.form.nodes[v], ball.x, HessianKind::Projected);
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(projected).eigenvalues().minCoeff() >= 0.499);
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(projected - H).eigenvalues().minCoeff() > -1e-9 * H.norm());
  }
}

TEST_CASE("slide form: a node that goes with its bone has no energy, one that slides far only the fascia's") {
  OnBall ball;
  for (int v = 0; v < 5; ++v) {
    const Eigen::RowVector3d rest = ball.form.nodes[v].rest;
    const auto put = [&](const glm::dvec3& in_bone) {
      const glm::dvec3 p = ball.form.posed_from_rest[1] * in_bone;
      ball.x.row(v) << p.x, p.y, p.z;
    };
    put({rest[0], rest[1], rest[2]});
    CHECK(ball.form.slide_of(ball.form.nodes[v], ball.x).along < 1e-12);
    // Moves the node to the opposite point of the ball, so that it has slid by the diameter, measured straight.
    put({-rest[0], -rest[1], -rest[2]});
    const SlideForm::Slide slide = ball.form.slide_of(ball.form.nodes[v], ball.x);
    CHECK(slide.along == doctest::Approx(2 * rest.norm()));
    CHECK(slide.off < 1e-4);
    put({rest[0], rest[1], rest[2]});
  }
  CHECK(ball.form.value(ball.x) < 1e-20);
}

TEST_CASE(
    "distance field: the distance from a meshed rod is right near it and beyond the table, and its slope is one") {
  // A rod of bone with a radius of 10 mm, meshed with edges of 2 mm.
  TetMesh mesh = thick_cylinder(1e-3, 10, 40, 5, 31, 20);
  mesh.region.assign(mesh.T.rows(), 1);
  std::vector<int> around;
  for (int v = 0; v < int(mesh.V.rows()); ++v)
    if (std::abs(mesh.V(v, 2) - 20) < 5 && Sleeve::radius(mesh.V.row(v)) > 9.9) around.push_back(v);
  const DistanceField field(mesh, 1, around, 8, 0.5, 0.6);
  for (const double angle : {0.0, 0.31, 1.0, 2.2, 4.7})
    for (const double r : {8.5, 9.5, 10.0, 11.0, 14.0}) {
      const DistanceAt at = field.at(Eigen::RowVector3d(r * std::cos(angle), r * std::sin(angle), 20.3));
      INFO("angle ", angle, " radius ", r);
      CHECK(std::abs(at.mm - (r - 10)) < (r < 12 ? 0.1 : 0.4));
      if (r > 12) continue;  // far away only a rough distance is needed
      CHECK(at.slope.norm() == doctest::Approx(1).epsilon(0.03));
      CHECK(at.slope.dot(Eigen::Vector3d(std::cos(angle), std::sin(angle), 0)) > 0.98);
    }
  CHECK(field.at(Eigen::RowVector3d(40, 0, 20)).mm == doctest::Approx(30).epsilon(0.02));
}

TEST_CASE("slide form: a sleeve pulled along a rod has Lame's shape at every preset, better with smaller tets") {
  double before = 0;
  for (const int across : {8, 12, 24}) {
    const auto [worst, rms] = Sleeve(across).pulled();
    MESSAGE(across, " tets across: worst ", worst, ", rms ", rms);
    CHECK(rms < 0.02);
    if (before > 0 && across == 24) CHECK(std::log(before / rms) / std::log(2.0) > 1.5);
    before = rms;
  }
}

TEST_CASE("slide form: a sleeve twisted about a rod slides as far as its fascia lets it, at every preset" *
          doctest::test_suite("slow")) {
  double before = 0;
  for (const int across : {8, 12, 24}) {
    const auto [worst, rms] = Sleeve(across).twisted();
    MESSAGE(across, " tets across: worst ", worst, ", rms ", rms);
    CHECK(rms < 0.02);
    if (before > 0 && across == 24) CHECK(std::log(before / rms) / std::log(2.0) > 1.5);
    before = rms;
  }
}
