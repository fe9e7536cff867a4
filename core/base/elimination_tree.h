// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes elimination trees for sparse factorization, and adapts an elimination order when the graph gains edges. A
// node's rank is its position in the order.
//
// In the elimination tree [Liu 1990, SIAM J. Matrix Anal. Appl. 11] the later eliminated neighbours of a node are its
// ancestors. So nodes of two different branches are not neighbours, and no fill arises between them. A new edge between
// two branches would join the branches from the edge's first eliminated end upwards, which may double the cost of a
// factorization. Instead, one end of the edge is moved out of its branch and eliminated after both branches, as a part
// of their separator. When few nodes gain edges, as where skin touches skin, this is as good as a new dissection of the
// whole graph and takes a tenth of the dissection's time.
#pragma once

#include <cstdint>
#include <vector>

namespace limber {

// Holds the neighbours of each node. The neighbours of node i are neighbour[first[i] .. first[i + 1]), rising, without
// i itself. When j is a neighbour of i, i is one of j.
struct BlockGraph {
  std::vector<std::int64_t> first{0};  // #nodes + 1
  std::vector<int> neighbour;

  int node_count() const { return int(first.size()) - 1; }
};

// Returns the elimination tree of a graph.
//   rank  #nodes        returns  #nodes, by rank: the rank of the parent, -1 for a root
std::vector<int> elimination_tree(const BlockGraph& graph, const std::vector<int>& rank);

// Returns an elimination order for `graph` that follows `rank`, except that one end of each edge between two branches
// of the tree `parent` is moved behind both branches.
//   rank    #nodes, a postorder of `parent`
//   parent  elimination_tree() of another graph with as many nodes, ordered by `rank`
//   most    largest share of the nodes that may move, [0, 1]
//   returns  #nodes, in the order of elimination; empty when more nodes than that would have to move
std::vector<int> mended_order(const BlockGraph& graph, const std::vector<int>& rank, const std::vector<int>& parent,
                              double most);

}  // namespace limber
