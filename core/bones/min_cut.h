// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the minimum cut of a graph of voxels between a source and a sink by two search trees that grow towards each
// other [Boykov & Kolmogorov 2004]. Capacities are integers, so the result does not depend on rounding.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace limber {

// A graph of voxels whose edges have capacities.
//   Edges  edges per node: 26 to all neighbours of a voxel, or 6 to the neighbours across its faces
template <int Edges>
struct CutGraph {
  // Neighbours of each node; -1: none. If edge k of node i leads to j, then edge Edges - 1 - k of node j leads back to
  // i.
  std::vector<std::array<std::int32_t, Edges>> neighbour;
  // Capacity of each edge, in the direction towards the neighbour.
  std::vector<std::array<std::int32_t, Edges>> capacity;
  // For each node; positive: capacity from the source, negative: capacity to the sink.
  std::vector<std::int32_t> terminal;
};

// Returns 1 for every node on the source's side of a minimum cut, else 0. Nodes that the source cannot reach after the
// cut count as on the sink's side. The sum of the positive `terminal` values must stay below 2^62.
template <int Edges>
std::vector<std::uint8_t> min_cut(CutGraph<Edges> graph);
extern template std::vector<std::uint8_t> min_cut(CutGraph<6> graph);
extern template std::vector<std::uint8_t> min_cut(CutGraph<26> graph);

}  // namespace limber
