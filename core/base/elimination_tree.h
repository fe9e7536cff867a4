// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes elimination trees for sparse factorization, and adapts an elimination order when the graph gains edges. A
// node's rank is its position in the order.
//
// In the elimination tree [Liu 1990, SIAM J. Matrix Anal. Appl. 11] the later eliminated neighbours of a node are its
// ancestors. So nodes of two different branches are not neighbours, and no fill arises between them. A new edge between
// two branches would join the branches, from that end of the edge that is eliminated first up to the root, which may
// double the cost of a factorization. Instead, one end of the edge is moved out of its branch and eliminated after both
// branches, as a part of their separator. When few nodes gain edges, as where skin touches skin, this is as good as a
// new dissection of the whole graph and takes a tenth of the dissection's time.
#pragma once

#include <cstdint>
#include <vector>

namespace limber {

// The neighbours of each node of a graph. Those of node i are neighbour[first[i] .. first[i + 1]), in rising order,
// without i itself. When j is a neighbour of i, then i is also a neighbour of j.
struct BlockGraph {
  std::vector<std::int64_t> first{0};  // #nodes + 1 indices into `neighbour`
  std::vector<int> neighbour;

  int node_count() const { return int(first.size()) - 1; }
};

// Returns the elimination tree of a graph.
//   rank     #nodes: position of each node in the elimination order
//   returns  #nodes, by rank: the parent's rank, -1 for a root
std::vector<int> elimination_tree(const BlockGraph& graph, const std::vector<int>& rank);

// Returns an elimination order for `graph` that follows `rank`, except for edges between two branches of the tree
// `parent`: one end of each such edge is moved behind both branches.
//   rank    #nodes, a postorder of `parent`
//   parent  elimination_tree() of another graph with the same number of nodes, ordered by `rank`
//   most    largest share of the nodes that may move, [0, 1]
//   returns  #nodes, in the order of elimination; empty when more nodes than `most` allows would have to move
std::vector<int> mended_order(const BlockGraph& graph, const std::vector<int>& rank, const std::vector<int>& parent,
                              double most);

}  // namespace limber
