// SPDX-License-Identifier: AGPL-3.0-or-later
// The minimum cut of a graph of voxels between a source and a sink [Boykov & Kolmogorov 2004: two search trees that
// meet]. Capacities are whole numbers, so the result does not depend on rounding.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace limber {

//   Edges  of a node: 26 to all neighbours of a voxel, 6 through its faces
template <int Edges>
struct CutGraph {
  // #n; -1 for none. Edge k of i leads to j, whose edge Edges - 1 - k leads back to i.
  std::vector<std::array<std::int32_t, Edges>> neighbour;
  std::vector<std::array<std::int32_t, Edges>> capacity;  // #n; of the way to the neighbour
  std::vector<std::int32_t> terminal;  // #n; what flows in from the source, or out to the sink where negative
};

// #n, 1 on the source's side of a minimum cut. What no flow reaches from the source lies on the sink's side.
// The sum of the positive terminals must stay below 2^62.
template <int Edges>
std::vector<std::uint8_t> min_cut(CutGraph<Edges> graph);
extern template std::vector<std::uint8_t> min_cut(CutGraph<6> graph);
extern template std::vector<std::uint8_t> min_cut(CutGraph<26> graph);

}  // namespace limber
