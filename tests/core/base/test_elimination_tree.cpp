// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/elimination_tree.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include <doctest/doctest.h>

using namespace limber;

namespace {
using Edges = std::set<std::pair<int, int>>;

BlockGraph graph_of(int nodes, const Edges& edges) {
  BlockGraph graph;
  std::vector<std::vector<int>> neighbours(nodes);
  for (const auto& [a, b] : edges) neighbours[a].push_back(b), neighbours[b].push_back(a);
  for (auto& each : neighbours) {
    std::sort(each.begin(), each.end());
    graph.neighbour.insert(graph.neighbour.end(), each.begin(), each.end());
    graph.first.push_back(std::ssize(graph.neighbour));
  }
  return graph;
}

Edges random_edges(int nodes, int count, std::mt19937& random) {
  Edges edges;
  for (int k = 0; k < count; ++k) {
    const int a = int(random() % nodes), b = int(random() % nodes);
    if (a != b) edges.insert(std::minmax(a, b));
  }
  return edges;
}

// Returns the nonzeros below the diagonal of each column of the factor, by rank, as symbolic elimination finds them.
std::vector<std::set<int>> filled(const BlockGraph& graph, const std::vector<int>& rank) {
  std::vector<std::set<int>> below(graph.node_count());
  for (int i = 0; i < graph.node_count(); ++i)
    for (auto k = graph.first[i]; k < graph.first[i + 1]; ++k)
      if (rank[graph.neighbour[k]] > rank[i]) below[rank[i]].insert(rank[graph.neighbour[k]]);
  for (auto& column : below)
    for (const int a : column)
      for (const int b : column)
        if (a < b) below[a].insert(b);
  return below;
}

std::size_t entries(const std::vector<std::set<int>>& below) {
  return std::accumulate(below.begin(), below.end(), std::size_t{0},
                         [](std::size_t sum, const auto& column) { return sum + column.size(); });
}

std::vector<int> rank_of(const std::vector<int>& order) {
  std::vector<int> rank(order.size());
  for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = int(r);
  return rank;
}

// Returns the edges of two n by n grids and the column of n separator nodes between them, numbered so that the
// separator is eliminated last.
Edges two_halves(int n) {
  Edges edges;
  const int middle = 2 * n * n;
  for (int half = 0; half < 2; ++half)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int node = half * n * n + i + n * j;
        if (i + 1 < n) edges.emplace(node, node + 1);
        if (j + 1 < n) edges.emplace(node, node + n);
        if (i == n - 1) edges.emplace(node, middle + j);
      }
  for (int j = 0; j + 1 < n; ++j) edges.emplace(middle + j, middle + j + 1);
  return edges;
}
}  // namespace

TEST_CASE("elimination: a node's parent is the first that it meets once those before it are eliminated") {
  std::mt19937 random(11);
  for (int round = 0; round < 30; ++round) {
    const int nodes = 5 + int(random() % 30);
    const BlockGraph graph = graph_of(nodes, random_edges(nodes, 2 * nodes, random));
    std::vector<int> rank(nodes);
    std::iota(rank.begin(), rank.end(), 0);
    std::shuffle(rank.begin(), rank.end(), random);
    const auto below = filled(graph, rank);
    const std::vector<int> parent = elimination_tree(graph, rank);
    for (int r = 0; r < nodes; ++r) CHECK(parent[r] == (below[r].empty() ? -1 : *below[r].begin()));
  }
}

TEST_CASE("elimination: an order for the same graph stays as it is, and one for more edges has every node once") {
  std::mt19937 random(3);
  const Edges edges = two_halves(8);
  const int nodes = 2 * 64 + 8;
  const BlockGraph graph = graph_of(nodes, edges);
  std::vector<int> rank(nodes);
  std::iota(rank.begin(), rank.end(), 0);
  const std::vector<int> parent = elimination_tree(graph, rank);
  CHECK(mended_order(graph, rank, parent, 0) == rank);
  for (int round = 0; round < 20; ++round) {
    Edges more = edges;
    more.merge(random_edges(nodes, 6, random));
    std::vector<int> order = mended_order(graph_of(nodes, more), rank, parent, 1);
    std::sort(order.begin(), order.end());
    CHECK(order == rank);
  }
}

TEST_CASE("elimination: what joins two branches goes between them, and fills far less in than the old order would") {
  constexpr int kSide = 12;
  const int nodes = 2 * kSide * kSide + kSide;
  Edges edges = two_halves(kSide);
  const BlockGraph before = graph_of(nodes, edges);
  std::vector<int> rank(nodes);
  std::iota(rank.begin(), rank.end(), 0);
  const std::vector<int> parent = elimination_tree(before, rank);
  // Connects two nodes of the first half, which are eliminated early, to some of the other half.
  for (const int far : {0, 3, 30}) edges.emplace(5, kSide * kSide + far), edges.emplace(17, kSide * kSide + far + 1);
  const BlockGraph after = graph_of(nodes, edges);
  const std::vector<int> order = mended_order(after, rank, parent, 1);
  const auto place = rank_of(order);
  for (const int moved : {5, 17}) {
    CHECK(place[moved] > place[2 * kSide * kSide - 1]);  // eliminated after both halves
    CHECK(place[moved] < place[2 * kSide * kSide]);      // eliminated before the separator
  }
  CHECK(entries(filled(after, place)) < 0.8 * double(entries(filled(after, rank))));
  CHECK(mended_order(after, rank, parent, 1.5 / nodes).empty());
}
