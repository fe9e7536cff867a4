// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/cholesky.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include "core/base/parallel.h"

using namespace limber;

namespace {
// Makes the graph of a grid of nodes in which the eight corners of each cell are connected.
BlockGraph grid_graph(int n) {
  BlockGraphBuilder builder(n * n * n);
  const auto node = [&](int i, int j, int k) { return i + n * (j + n * k); };
  for (int k = 0; k + 1 < n; ++k)
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i) {
        std::array<int, 8> cell;
        for (int c = 0; c < 8; ++c) cell[c] = node(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        builder.add(cell);
      }
  return builder.build();
}

// Fills the sparse and the dense matrix with the same random symmetric blocks; `diagonal` makes them positive definite.
Eigen::MatrixXd fill(Cholesky& sparse, const BlockGraph& graph, double diagonal) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int n = graph.node_count();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  sparse.clear();
  const auto put = [&](int a, int b, const Eigen::Matrix3d& block) {
    dense.block<3, 3>(3 * a, 3 * b) = block;
    dense.block<3, 3>(3 * b, 3 * a) = block.transpose();
    const bool turned = sparse.rank(a) < sparse.rank(b);
    const auto place = turned ? sparse.place(b, a) : sparse.place(a, b);
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) sparse.values()[place.at + c * place.stride + r] = turned ? block(c, r) : block(r, c);
  };
  for (int a = 0; a < n; ++a) {
    Eigen::Matrix3d own = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
    put(a, a, own + own.transpose() + diagonal * Eigen::Matrix3d::Identity());
    for (auto k = graph.first[a]; k < graph.first[a + 1]; ++k)
      if (graph.neighbour[k] < a)
        put(a, graph.neighbour[k], Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); }));
  }
  return dense;
}
}  // namespace

TEST_CASE("cholesky: the places of all pairs of some nodes are those of each pair") {
  BlockGraphBuilder builder(9);
  builder.add(std::array{0, 3, 5, 7});
  builder.add(std::array{1, 3, 8});
  builder.add(std::array{2, 4, 6, 8});
  const Cholesky matrix(builder.build());
  std::vector<int> nodes{0, 1, 3, 5, 7, 8};
  std::sort(nodes.begin(), nodes.end(), [&](int a, int b) { return matrix.rank(a) < matrix.rank(b); });
  nodes.insert(nodes.begin(), {-1, -1});
  std::vector<Cholesky::Place> places(nodes.size() * (nodes.size() + 1) / 2);
  matrix.places(nodes, places.data());
  int met = 0;
  for (std::size_t row = 0, k = 0; row < nodes.size(); ++row)
    for (std::size_t column = 0; column <= row; ++column, ++k) {
      const Cholesky::Place expected =
          nodes[row] < 0 || nodes[column] < 0 ? Cholesky::Place{-1, 0} : matrix.place(nodes[row], nodes[column]);
      CHECK(places[k].at == expected.at);
      if (expected.at < 0) continue;
      CHECK(places[k].stride == expected.stride);
      ++met;
    }
  CHECK(met == 6 + 6 + 3);
}

TEST_CASE("cholesky: a graph has every pair of nodes that meet in an element, once") {
  BlockGraphBuilder builder(5);
  builder.add(std::array{0, 2, 4});
  builder.add(std::array{4, 2, -1, 1});
  const BlockGraph graph = builder.build();
  CHECK(graph.first == std::vector<std::int64_t>{0, 2, 4, 7, 7, 10});
  CHECK(graph.neighbour == std::vector<int>{2, 4, 2, 4, 0, 1, 4, 0, 1, 2});
}

TEST_CASE("cholesky: solves as a dense factorization does, again and again with new values") {
  const BlockGraph graph = grid_graph(5);
  Cholesky sparse(graph);
  for (const double diagonal : {90.0, 200.0}) {
    const Eigen::MatrixXd dense = fill(sparse, graph, diagonal);
    REQUIRE(sparse.factorize());
    Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(dense.rows(), -3, 5);
    const Eigen::VectorXd expected = dense.llt().solve(b);
    REQUIRE(sparse.solve({b.data(), std::size_t(b.size())}));
    CHECK((b - expected).norm() <= 1e-9 * expected.norm());
  }
  CHECK(sparse.factor_size() > 0);
  CHECK(sparse.factor_operations() > 0);
}

TEST_CASE("cholesky: another graph, larger or smaller, is solved in the same memory to the same bits as on its own") {
  Cholesky sparse(grid_graph(4));
  for (const int size : {5, 3, 6}) {
    const BlockGraph graph = grid_graph(size);
    sparse.analyse(graph);
    Cholesky own(graph);
    std::vector<double> b(3 * graph.node_count(), 1), expected = b;
    fill(sparse, graph, 90);
    fill(own, graph, 90);
    REQUIRE(sparse.factorize());
    REQUIRE(own.factorize());
    REQUIRE(sparse.solve(b));
    REQUIRE(own.solve(expected));
    CHECK(b == expected);
  }
}

TEST_CASE(
    "cholesky: a graph that gains a few edges keeps its order but for their ends, costs little more than ordered anew, "
    "and is solved as well") {
  constexpr int kSize = 8;
  const BlockGraph base = grid_graph(kSize);
  Cholesky sparse(base);
  const auto ranks = [&] {
    std::vector<int> result;
    for (int i = 0; i < base.node_count(); ++i) result.push_back(sparse.rank(i));
    return result;
  };
  const std::vector<int> first = ranks();
  sparse.analyse(base);
  CHECK(ranks() == first);

  // Connects nodes of two opposite sides of the grid, as contact connects surfaces that meet.
  BlockGraphBuilder meeting(base.node_count());
  constexpr int kMeet = 6;
  for (int i = 0; i < kMeet; ++i) meeting.add(std::array{i, i + kSize * (kSize - 1)});
  const BlockGraph graph = meeting.build(base);
  sparse.analyse(graph);
  const Cholesky own(graph);
  CHECK(sparse.factor_operations() < 1.3 * own.factor_operations());
  // Mending moves few nodes, so most nodes change their rank by no more than the number of nodes that meet.
  const std::vector<int> mended = ranks();
  int near = 0;
  for (int i = 0; i < base.node_count(); ++i) near += std::abs(mended[i] - first[i]) <= kMeet;
  CHECK(near > base.node_count() / 2);

  const Eigen::MatrixXd dense = fill(sparse, graph, 200);
  REQUIRE(sparse.factorize());
  Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(dense.rows(), -3, 5);
  const Eigen::VectorXd expected = dense.llt().solve(b);
  REQUIRE(sparse.solve({b.data(), std::size_t(b.size())}));
  CHECK((b - expected).norm() <= 1e-9 * expected.norm());
}

TEST_CASE("cholesky: a matrix that is not positive definite is said to be, and spoils nothing for the next") {
  const BlockGraph graph = grid_graph(4);
  Cholesky sparse(graph);
  fill(sparse, graph, -1);
  CHECK_FALSE(sparse.factorize());
  const Eigen::MatrixXd dense = fill(sparse, graph, 90);
  REQUIRE(sparse.factorize());
  Eigen::VectorXd b = Eigen::VectorXd::Ones(dense.rows());
  REQUIRE(sparse.solve({b.data(), std::size_t(b.size())}));
  CHECK((dense * b - Eigen::VectorXd::Ones(dense.rows())).norm() < 1e-8);
}

TEST_CASE("cholesky: a matrix that single precision cannot factorize is solved in double precision, and counted") {
  const BlockGraph graph = grid_graph(5);
  Cholesky sparse(graph);
  fill(sparse, graph, 90);
  REQUIRE(sparse.factorize());
  std::vector<double> b(3 * graph.node_count(), 1);
  REQUIRE(sparse.solve(b));
  CHECK(sparse.repeated_in_double() == 0);

  // Each block is the product of two numbers that belong to its nodes, so the matrix has rank 3. With 1e-9 more on its
  // diagonal it is positive definite, with a condition number of about 1e11.
  const auto of_node = [](int node) { return 1 + 0.5 * std::sin(node); };
  const int n = graph.node_count();
  BlockGraphBuilder builder(n);
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  builder.add(all);
  const BlockGraph full = builder.build();
  sparse.analyse(full);
  sparse.clear();
  constexpr double kMore = 1e-9;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      const bool turned = sparse.rank(i) < sparse.rank(j);
      const auto place = turned ? sparse.place(j, i) : sparse.place(i, j);
      for (int c = 0; c < 3; ++c)
        sparse.values()[place.at + c * (place.stride + 1)] = of_node(i) * of_node(j) + (i == j ? kMore : 0);
    }
  REQUIRE(sparse.factorize());
  Eigen::VectorXd u(n), x(n);
  for (int i = 0; i < n; ++i) u[i] = of_node(i), x[i] = std::cos(3 * i);
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c) b[3 * i + c] = u[i] * u.dot(x) + kMore * x[i];
  REQUIRE(sparse.solve(b));
  CHECK(sparse.repeated_in_double() == 1);
  // The exact solution is x. Rounding of the right-hand side alone changes it by up to about 1e-16 * 1e11.
  for (int i = 0; i < n; ++i) CHECK(b[3 * i + 1] == doctest::Approx(x[i]).epsilon(1e-3));
}

TEST_CASE("cholesky: a matrix without zeros, wider than a supernode may be, is solved in single precision") {
  constexpr int kNodes = 200;  // three columns each, 600 in all
  std::vector<int> all(kNodes);
  std::iota(all.begin(), all.end(), 0);
  BlockGraphBuilder builder(kNodes);
  builder.add(all);
  const BlockGraph graph = builder.build();
  Cholesky sparse(graph);
  const Eigen::MatrixXd dense = fill(sparse, graph, 900);
  REQUIRE(sparse.factorize());
  Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(dense.rows(), -3, 5);
  const Eigen::VectorXd expected = dense.llt().solve(b);
  REQUIRE(sparse.solve({b.data(), std::size_t(b.size())}));
  CHECK(sparse.repeated_in_double() == 0);
  CHECK((b - expected).norm() <= 1e-9 * expected.norm());
}

TEST_CASE("cholesky: stiff and soft parts side by side need no double precision") {
  const BlockGraph graph = grid_graph(5);
  Cholesky sparse(graph);
  Eigen::MatrixXd dense = fill(sparse, graph, 90);
  // Multiplies the rows and columns of every third node by 1e6, as stiff springs and contact do.
  const auto factor = [](Eigen::Index row) { return row / 3 % 3 ? 1.0 : 1e6; };
  for (int i = 0; i < graph.node_count(); ++i)
    for (int j = 0; j < graph.node_count(); ++j) {
      if (sparse.rank(i) < sparse.rank(j)) continue;
      const auto place = sparse.place(i, j);
      if (place.at < 0) continue;
      for (int k = 0; k < 9; ++k)
        sparse.values()[place.at + k / 3 * place.stride + k % 3] *= factor(3 * i) * factor(3 * j);
    }
  for (Eigen::Index r = 0; r < dense.rows(); ++r)
    for (Eigen::Index c = 0; c < dense.cols(); ++c) dense(r, c) *= factor(r) * factor(c);
  REQUIRE(sparse.factorize());
  Eigen::VectorXd b = Eigen::VectorXd::Ones(dense.rows());
  const Eigen::VectorXd expected = dense.llt().solve(b);
  REQUIRE(sparse.solve({b.data(), std::size_t(b.size())}));
  CHECK(sparse.repeated_in_double() == 0);
  const Eigen::VectorXd off = b - expected;
  CHECK(off.dot(dense * off) <= 1e-18 * expected.dot(dense * expected));
}

TEST_CASE("cholesky: the same for one thread and two, bit for bit") {
  const BlockGraph graph = grid_graph(9);
  std::vector<double> first;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    Cholesky sparse(graph);
    fill(sparse, graph, 90);
    REQUIRE(sparse.factorize());
    std::vector<double> b(3 * graph.node_count(), 1.0);
    REQUIRE(sparse.solve(b));
    if (threads == 1) first = b;
    CHECK(b == first);
  }
}
