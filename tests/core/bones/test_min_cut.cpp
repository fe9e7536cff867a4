// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/min_cut.h"

#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {
enum class Ways { Alike, Differ };  // capacities of the two directions of an edge: equal, or random each

// Makes a cube of `side` voxels with random capacities: 0 to `most_edge` for edges, -`most_terminal` (sink) to
// `most_terminal` (source) for terminals. Edge k of the 26 leads to the k-th neighbour in z, y, x order.
CutGraph<26> random_cube(int side, unsigned seed, int most_edge, int most_terminal, Ways ways) {
  std::mt19937 random(seed);
  CutGraph<26> graph;
  const int count = side * side * side;
  std::array<std::int32_t, 26> none;
  none.fill(-1);
  graph.neighbour.assign(count, none);
  graph.capacity.assign(count, {});
  graph.terminal.resize(count);
  for (int i = 0; i < count; ++i) {
    graph.terminal[i] = static_cast<int>(random() % (2 * most_terminal + 1)) - most_terminal;
    for (int k = 13; k < 26; ++k) {
      const int step = k + 1, x = i % side + step % 3 - 1, y = i / side % side + step / 3 % 3 - 1,
                z = i / side / side + step / 9 - 1;
      if (x < 0 || y < 0 || z < 0 || x >= side || y >= side || z >= side) continue;
      const int j = x + side * (y + side * z);
      graph.neighbour[i][k] = j;
      graph.neighbour[j][25 - k] = i;
      graph.capacity[i][k] = graph.capacity[j][25 - k] = static_cast<int>(random() % (most_edge + 1));
      if (ways == Ways::Differ) graph.capacity[j][25 - k] = static_cast<int>(random() % (most_edge + 1));
    }
  }
  return graph;
}
std::int64_t cost_of(const CutGraph<26>& graph, const std::vector<std::uint8_t>& is_source) {
  std::int64_t cost = 0;
  for (std::size_t i = 0; i < is_source.size(); ++i) {
    if (graph.terminal[i] > 0 && !is_source[i]) cost += graph.terminal[i];
    if (graph.terminal[i] < 0 && is_source[i]) cost -= graph.terminal[i];
    for (int k = 0; k < 26; ++k)
      if (const int n = graph.neighbour[i][k]; n >= 0 && is_source[i] && !is_source[n]) cost += graph.capacity[i][k];
  }
  return cost;
}
}  // namespace

TEST_CASE("min cut: no other cut of a small graph costs less") {
  for (unsigned seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    const CutGraph<26> graph = random_cube(2, seed, 9, 12, seed % 2 ? Ways::Differ : Ways::Alike);
    const std::int64_t found = cost_of(graph, min_cut(graph));
    for (int pattern = 0; pattern < 256; ++pattern) {
      std::vector<std::uint8_t> is_source(8);
      for (int i = 0; i < 8; ++i) is_source[i] = pattern >> i & 1;
      REQUIRE(found <= cost_of(graph, is_source));
    }
  }
}

TEST_CASE("min cut: in a larger graph no voxel and no slab can change sides for less") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    const CutGraph<26> graph = random_cube(9, seed, 5, 40, seed % 2 ? Ways::Differ : Ways::Alike);
    const std::vector<std::uint8_t> cut = min_cut(graph);
    const std::int64_t found = cost_of(graph, cut);
    for (std::size_t i = 0; i < cut.size(); ++i) {
      std::vector<std::uint8_t> other = cut;
      other[i] ^= 1;
      REQUIRE(found <= cost_of(graph, other));
    }
    for (int slab = 0; slab < 9; ++slab)
      for (const int side : {0, 1}) {
        std::vector<std::uint8_t> other = cut;
        for (int i = 81 * slab; i < 81 * (slab + 1); ++i) other[i] = static_cast<std::uint8_t>(side);
        REQUIRE(found <= cost_of(graph, other));
      }
  }
}

TEST_CASE("min cut: two bars joined by one edge part at it, and what is tied to neither side lies on the sink's") {
  CutGraph<26> graph;
  std::array<std::int32_t, 26> none;
  none.fill(-1);
  graph.neighbour.assign(7, none);
  graph.capacity.assign(7, {});
  graph.terminal = {100, 0, 0, 0, 0, -100, 0};
  for (int i = 0; i < 5; ++i) {
    graph.neighbour[i][13] = i + 1;
    graph.neighbour[i + 1][12] = i;
    graph.capacity[i][13] = graph.capacity[i + 1][12] = i == 2 ? 3 : 8;
  }
  CHECK(min_cut(graph) == std::vector<std::uint8_t>{1, 1, 1, 0, 0, 0, 0});
}
