// SPDX-License-Identifier: AGPL-3.0-or-later
// The cheapest cut between two sets of nodes of a graph whose nodes have at most six neighbours, as voxels have. Dinic's
// algorithm: blocking flows on layered graphs [Dinic 1970], the ways searched without recursion. Capacities are whole numbers,
// so the same graph gives the same cut on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace limber {

class MaxFlow {
 public:
  enum class Side : std::uint8_t { Free, Source, Sink };

  explicit MaxFlow(std::int32_t nodes) : edges_(nodes), side_(nodes, Side::Free) {}

  void fix(std::int32_t node, Side side) { side_[node] = side; }
  // `slot`: of the six of `a`, and of `b`; each is used once.
  void connect(std::int32_t a, int slot_a, std::int32_t b, int slot_b, std::int32_t capacity) {
    edges_[a][slot_a] = {b, capacity, std::uint8_t(slot_b)};
    edges_[b][slot_b] = {a, capacity, std::uint8_t(slot_a)};
  }
  // Whether each node lies on the side of the source. Of equal cuts the one nearest to the source.
  std::vector<bool> source_side();

 private:
  struct Edge {
    std::int32_t to = -1, left = 0;
    std::uint8_t back = 0;
  };
  bool find_layers();
  void push_all();

  std::vector<std::array<Edge, 6>> edges_;
  std::vector<Side> side_;
  std::vector<std::int32_t> layer_;
  std::vector<std::uint8_t> next_;
  std::vector<std::int32_t> reached_;
};

}  // namespace limber
