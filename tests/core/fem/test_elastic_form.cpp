// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/elastic_form.h"

#include <numeric>
#include <random>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include "core/base/parallel.h"
#include "core/fem/material.h"
#include "core/fem/patch_form.h"
#include "core/fem/step_bound.h"
#include "tests/support/tet_shapes.h"

using namespace limber;

namespace {
// A small box of several materials with patches and a barrier. Its nodes are moved at random, as far as no tet inverts.
struct Shaken {
  TetMesh mesh = kuhn_box(2, 2, 2, {0, 0, 0}, {2, 2.5, 2.2});
  NodePositions rest = mesh.V, x;
  ElasticForm tets;
  PatchForm patches;
  std::vector<int> unknown;
  Cholesky matrix;

  static BlockGraph complete(int nodes) {
    std::vector<int> all(nodes);
    std::iota(all.begin(), all.end(), 0);
    BlockGraphBuilder builder(nodes);
    builder.add(all);
    return builder.build();
  }

  explicit Shaken(double by, unsigned seed = 3, double poisson_ratio = 0.49) : matrix(complete(27)) {
    std::vector<double> bulk(mesh.T.rows()), shear(mesh.T.rows());
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
      const TetMaterial material{t % 3 == 0 ? 4.0 : 1.0, t % 5 == 0 ? 0.3 : poisson_ratio};
      bulk[t] = patch_bulk(material), shear[t] = material.shear_modulus;
    }
    const PatchOrder order = grow_patches(rest, mesh.T, bulk, shear);
    Eigen::MatrixX4i T(mesh.T.rows(), 4);
    std::vector<TetEnergy> energy(mesh.T.rows());
    std::vector<double> ordered(mesh.T.rows()), filled(mesh.T.rows());
    for (Eigen::Index k = 0; k < T.rows(); ++k) {
      T.row(k) = mesh.T.row(order.tet[k]);
      ordered[k] = bulk[order.tet[k]];
      filled[k] = 0.3 + 0.1 * double(k % 9);
      energy[k] = {shear[order.tet[k]], 2, 5, 0.7};
    }
    tets = ElasticForm(rest, T, energy, order.first);
    patches = PatchForm(tets, order.first, ordered, filled);
    unknown.resize(27);
    std::iota(unknown.begin(), unknown.end(), 0);
    tets.assign_nodes(matrix, unknown);

    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const NodePositions shake = NodePositions::NullaryExpr(27, 3, [&] { return uniform(random); });
    for (x = rest + by * shake; count_inverted(mesh.T, x) > 0; x = rest + by * shake) by *= 0.9;
  }

  double value(const NodePositions& at) const {
    std::vector<double> J;
    tets.volume_ratios(at, J);
    return tets.value(at, J) + patches.value(J);
  }
  NodePositions gradient(const NodePositions& at) const {
    std::vector<double> J, pressure;
    tets.volume_ratios(at, J);
    patches.pressures(J, pressure);
    NodePositions g = NodePositions::Zero(27, 3);
    tets.add_gradient(at, pressure, g);
    return g;
  }
  // Returns the Hessian, and the gradient in `g`.
  Eigen::MatrixXd hessian(const NodePositions& at, HessianKind curvature, NodePositions& g) {
    std::vector<double> J, pressure;
    tets.volume_ratios(at, J);
    patches.pressures(J, pressure);
    g = NodePositions::Zero(27, 3);
    matrix.clear();
    tets.add_derivatives(at, pressure, patches.stiffness(), curvature, g, matrix.values());
    Eigen::MatrixXd H(81, 81);
    for (int a = 0; a < 27; ++a)
      for (int b = 0; b < 27; ++b) {
        if (matrix.rank(a) < matrix.rank(b)) continue;
        const auto place = matrix.place(a, b);
        for (int c = 0; c < 3; ++c)
          for (int r = a == b ? c : 0; r < 3; ++r)
            H(3 * a + r, 3 * b + c) = H(3 * b + c, 3 * a + r) = matrix.values()[place.at + c * place.stride + r];
      }
    return H;
  }
};
}  // namespace

TEST_CASE("elastic form: forces are the slope of the energy") {
  for (const double by : {0.02, 0.3, 2.0}) {
    const Shaken shaken(by);
    const NodePositions g = shaken.gradient(shaken.x);
    const double scale = g.cwiseAbs().maxCoeff();
    for (int v = 0; v < 27; ++v)
      for (int c = 0; c < 3; ++c) {
        const double h = 1e-6;
        NodePositions plus = shaken.x, minus = shaken.x;
        plus(v, c) += h;
        minus(v, c) -= h;
        CHECK(std::abs((shaken.value(plus) - shaken.value(minus)) / (2 * h) - g(v, c)) < 1e-6 * scale);
      }
  }
}

TEST_CASE("elastic form: curvature is the slope of the forces, whether or not they are summed with it") {
  for (const double by : {0.02, 0.3, 2.0}) {
    Shaken shaken(by);
    NodePositions with;
    const Eigen::MatrixXd H = shaken.hessian(shaken.x, HessianKind::Exact, with);
    CHECK((with - shaken.gradient(shaken.x)).norm() <= 1e-13 * with.norm());
    const double scale = H.cwiseAbs().maxCoeff();
    for (int v = 0; v < 27; ++v)
      for (int c = 0; c < 3; ++c) {
        const double h = 1e-6;
        NodePositions plus = shaken.x, minus = shaken.x;
        plus(v, c) += h;
        minus(v, c) -= h;
        const NodePositions slope = (shaken.gradient(plus) - shaken.gradient(minus)) / (2 * h);
        CHECK((slope.reshaped<Eigen::RowMajor>() - H.col(3 * v + c)).cwiseAbs().maxCoeff() < 1e-5 * scale);
      }
  }
}

TEST_CASE(
    "elastic form: projected curvature has nothing negative, and is the exact one where that has nothing negative "
    "either") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Shaken shaken(seed < 3 ? 0.3 : 3.0, seed, 0.4);
    NodePositions g;
    const Eigen::MatrixXd exact = shaken.hessian(shaken.x, HessianKind::Exact, g),
                          projected = shaken.hessian(shaken.x, HessianKind::Projected, g);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected).eigenvalues();
    CHECK(values[0] >= -1e-10 * std::max(1.0, values[80]));
    CHECK(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(projected - exact).eigenvalues()[0] >=
          -1e-10 * std::max(1.0, values[80]));
    // The shaken box has negative eigenvalues, so the projection changes something.
    CHECK((projected - exact).norm() > 1e-6);
  }
  // With patches (groups of tets that share a pressure of any sign), the projected Hessian has no negative eigenvalues
  // either.
  for (unsigned seed = 0; seed < 3; ++seed) {
    Shaken shaken(2.0, seed);
    NodePositions g;
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(shaken.hessian(shaken.x, HessianKind::Projected, g))
            .eigenvalues();
    CHECK(values[0] >= -1e-10 * std::max(1.0, values[80]));
  }
  // If the box is scaled up a little, all eigenvalues are positive and the projection changes nothing.
  Shaken blown(0, 0, 0.4);
  blown.x = 1.001 * blown.rest;
  NodePositions g;
  CHECK((blown.hessian(blown.x, HessianKind::Projected, g) - blown.hessian(blown.x, HessianKind::Exact, g)).norm() <
        1e-10);
}

TEST_CASE(
    "elastic form: in a large body, too, some of whose nodes are no unknowns, in any order of the matrix, with one "
    "thread and two") {
  const TetMesh mesh = kuhn_box(9, 8, 7, {0, 0, 0}, {9, 8, 7});
  const int nodes = int(mesh.V.rows());
  const PatchOrder order =
      grow_patches(mesh.V, mesh.T, std::vector<double>(mesh.T.rows(), 90), std::vector<double>(mesh.T.rows(), 1));
  Eigen::MatrixX4i T(mesh.T.rows(), 4);
  for (Eigen::Index k = 0; k < T.rows(); ++k) T.row(k) = mesh.T.row(order.tet[k]);
  ElasticForm tets(mesh.V, T, std::vector<TetEnergy>(T.rows(), {1, 2, 5, 0.7}), order.first);
  const PatchForm patches(tets, order.first, std::vector<double>(T.rows(), 90), std::vector<double>(T.rows(), 0.8));
  std::vector<int> unknown(nodes, -1), node_of;
  for (int v = 0; v < nodes; ++v)
    if (v % 7 != 3) unknown[v] = int(node_of.size()), node_of.push_back(v);

  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const NodePositions x = mesh.V + 0.08 * NodePositions::NullaryExpr(nodes, 3, [&] { return uniform(random); });
  REQUIRE(count_inverted(T, x) == 0);
  NodePositions way = NodePositions::NullaryExpr(nodes, 3, [&] { return uniform(random); });
  for (int v = 0; v < nodes; ++v)
    if (unknown[v] < 0) way.row(v).setZero();
  const auto gradient = [&](const NodePositions& at) {
    std::vector<double> J, pressure;
    tets.volume_ratios(at, J);
    patches.pressures(J, pressure);
    NodePositions g = NodePositions::Zero(nodes, 3);
    tets.add_gradient(at, pressure, g);
    return g;
  };
  const double h = 1e-6;
  const NodePositions slope = (gradient(x + h * way) - gradient(x - h * way)) / (2 * h);

  BlockGraphBuilder builder(int(node_of.size()));
  tets.add_sparsity(builder, unknown);
  Cholesky matrix(builder.build());
  for (const bool once_more : {false, true}) {
    if (once_more) {
      for (int k = 0; k + 40 < std::ssize(node_of); k += 5) builder.add(std::array{k, k + 40});
      matrix.analyse(builder.build());
    }
    tets.assign_nodes(matrix, unknown);
    std::vector<double> first;
    for (const int threads : {1, 2}) {
      const ThreadCount count(threads);
      std::vector<double> J, pressure;
      tets.volume_ratios(x, J);
      patches.pressures(J, pressure);
      NodePositions g = NodePositions::Zero(nodes, 3);
      matrix.clear();
      tets.add_derivatives(x, pressure, patches.stiffness(), HessianKind::Exact, g, matrix.values());
      if (threads == 1) first.assign(matrix.values().begin(), matrix.values().end());
      else CHECK(std::equal(first.begin(), first.end(), matrix.values().begin()));
    }
    NodePositions product = NodePositions::Zero(nodes, 3);
    for (int a = 0; a < std::ssize(node_of); ++a)
      for (int b = 0; b < std::ssize(node_of); ++b) {
        if (matrix.rank(a) < matrix.rank(b)) continue;
        const auto place = matrix.place(a, b);
        if (place.at < 0) continue;
        for (int c = 0; c < 3; ++c)
          for (int r = a == b ? c : 0; r < 3; ++r) {
            const double value = matrix.values()[place.at + c * place.stride + r];
            product(node_of[a], r) += value * way(node_of[b], c);
            if (a != b || r != c) product(node_of[b], c) += value * way(node_of[a], r);
          }
      }
    double off = 0;
    for (const int v : node_of) off = std::max(off, (product.row(v) - slope.row(v)).cwiseAbs().maxCoeff());
    CHECK(off < 1e-6 * slope.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("elastic form: a rotation costs nothing and pulls at nothing") {
  const Shaken shaken(0);
  const Eigen::Matrix3d R = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.1).normalized().toRotationMatrix();
  const NodePositions turned = (shaken.rest * R.transpose()).rowwise() + Eigen::RowVector3d(3, -8, 1);
  CHECK(std::abs(shaken.value(turned)) < 1e-12);
  CHECK(shaken.gradient(turned).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("elastic form: an inverted tet costs infinitely much") {
  const Shaken shaken(0);
  NodePositions x = shaken.rest;
  x.row(13) += Eigen::RowVector3d(9, 0, 0);
  CHECK(std::isinf(shaken.value(x)));
}

TEST_CASE("patch form: every tet is in one patch, patches hang together by faces and have about eight tets") {
  const TetMesh mesh = kuhn_box(7, 6, 5, {0, 0, 0}, {7, 6, 5});
  std::vector<double> bulk(mesh.T.rows(), 100), shear(mesh.T.rows(), 1);
  for (Eigen::Index t = 0; t < 200; ++t) bulk[t] = 0;
  for (Eigen::Index t = 600; t < mesh.T.rows(); ++t) shear[t] = 40;
  const PatchOrder order = grow_patches(mesh.V, mesh.T, bulk, shear);
  std::vector<std::int64_t> sorted = order.tet;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t t = 0; t < sorted.size(); ++t) REQUIRE(sorted[t] == std::int64_t(t));
  REQUIRE(sorted.size() == std::size_t(mesh.T.rows()));

  int small = 0;
  for (std::size_t p = 0; p + 1 < order.first.size(); ++p) {
    const std::vector<std::int64_t> patch(order.tet.begin() + order.first[p], order.tet.begin() + order.first[p + 1]);
    if (bulk[patch[0]] == 0) {
      CHECK(patch.size() == 1);
      continue;
    }
    small += patch.size() < 5;
    CHECK(patch.size() <= 16);
    std::vector<std::int64_t> reached{patch[0]};
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (const auto t : patch) {
        int shared = 0;
        for (const int a : mesh.T.row(t)) shared += int((mesh.T.row(reached[k]).array() == a).count());
        if (shared == 3 && std::find(reached.begin(), reached.end(), t) == reached.end()) reached.push_back(t);
      }
    CHECK(reached.size() == patch.size());
    for (const auto t : patch) CHECK(shear[t] == shear[patch[0]]);
  }
  CHECK(small < std::ssize(order.first) / 20);
}

TEST_CASE("step bound: the step ends where the first tet has a tenth of its volume, or what it must keep, exactly") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const TetMesh mesh = kuhn_box(3, 3, 3, {0, 0, 0}, {3, 3, 3});
  const NodePositions x = mesh.V;
  for (int round = 0; round < 60; ++round) {
    const NodePositions step =
        (round < 30 ? 0.15 : 2.0) * NodePositions::NullaryExpr(x.rows(), 3, [&] { return uniform(random); });
    const double limit = 8;
    for (const double must : {0.0, 0.3, 0.7}) {  // share of its volume that every second tet must keep
      CAPTURE(must);
      std::vector<double> keep, least;
      for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
        const double share = t % 2 ? must : 0;
        keep.push_back(share * determinant(x, mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3)));
        least.push_back(std::max(0.1, std::min(share, 0.5)));
      }
      const StepBound bound = largest_step(mesh.T, x, step, limit, must > 0 ? keep : std::vector<double>());
      REQUIRE(bound.length > 0);
      const auto share = [&](Eigen::Index t, double length) {
        const NodePositions there = x + length * step;
        return determinant(there, mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3)) /
               determinant(x, mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3));
      };
      for (int k = 1; k <= 40; ++k)
        for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) REQUIRE(share(t, bound.length * k / 40) >= least[t] - 1e-9);
      if (bound.length < limit)
        CHECK(share(bound.tet, bound.length) == doctest::Approx(least[bound.tet]).epsilon(1e-6));
    }
  }
}
