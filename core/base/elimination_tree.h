// SPDX-License-Identifier: AGPL-3.0-or-later
// The order in which the nodes of a graph are eliminated by a sparse factorization, and how one is mended when the
// graph gains edges. Ranks are places in the order.
//
// In the elimination tree [Liu 1990, SIAM J. Matrix Anal. Appl. 11] every neighbour of a node that is eliminated after
// it is one of its ancestors: what lies in two branches does not meet, and so fills nothing in. An edge between two
// branches joins them from the first of its ends on, which may double the cost of a factorization. Instead one end of
// it is taken out of its branch and eliminated last of what both branches hold, as a part of the separator between
// them: where few nodes gain edges, as at skin that meets skin, that is as good as another dissection of the whole
// graph, and takes a tenth of its time.
#pragma once

#include <cstdint>
#include <vector>

namespace limber {

// Which nodes meet in a block: the neighbours of node i are neighbour[first[i] .. first[i + 1]), rising, without i
// itself, and each also has i as its neighbour.
struct BlockGraph {
  std::vector<std::int64_t> first{0};  // #nodes + 1
  std::vector<int> neighbour;

  int node_count() const { return int(first.size()) - 1; }
};

// rank  #nodes        returns  #nodes, by rank: the rank of the parent, -1 of a root
std::vector<int> elimination_tree(const BlockGraph& graph, const std::vector<int>& rank);

// The nodes in an order for `graph` that follows `rank`, but for ends of edges that join two branches of `parent`.
//   rank    #nodes, a postorder of its tree        parent  elimination_tree() of another graph of as many nodes by it
//   returns  #nodes, the first eliminated first; none where more than the share `most` of the nodes would change places
std::vector<int> mended_order(const BlockGraph& graph, const std::vector<int>& rank, const std::vector<int>& parent,
                              double most);

}  // namespace limber
