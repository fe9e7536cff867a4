// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/elimination_tree.h"

#include <algorithm>
#include <queue>
#include <utility>

namespace limber {

namespace {
std::vector<int> inverse(const std::vector<int>& rank) {
  std::vector<int> node(rank.size());
  for (int i = 0; i < int(rank.size()); ++i) node[rank[i]] = i;
  return node;
}

// An edge of the graph between two branches of the elimination tree: the ranks of the edge's two nodes, and the rank of
// the lowest common ancestor at which the branches join (#nodes if they never join).
struct Joint {
  int low, high, joined_at;
};

std::vector<Joint> edges_between_branches(const BlockGraph& graph, const std::vector<int>& rank,
                                          const std::vector<int>& parent) {
  const int n = graph.node_count();
  std::vector<int> lowest(
      // For each rank r, the lowest rank in the subtree with the root r. In a postorder, the subtree holds all ranks
      // from this lowest rank to r.
      n);
  for (int r = 0; r < n; ++r) lowest[r] = r;
  for (int r = 0; r < n; ++r)
    if (parent[r] >= 0) lowest[parent[r]] = std::min(lowest[parent[r]], lowest[r]);

  std::vector<Joint> joints;
  for (int i = 0; i < n; ++i)
    for (auto k = graph.first[i]; k < graph.first[i + 1]; ++k) {
      const int low = rank[i], high = rank[graph.neighbour[k]];
      if (low > high || lowest[high] <= low) continue;
      int at = parent[high];
      while (at >= 0 && lowest[at] > low) at = parent[at];
      joints.push_back({low, high, at < 0 ? n : at});
    }
  return joints;
}
}  // namespace

std::vector<int> elimination_tree(const BlockGraph& graph, const std::vector<int>& rank) {
  const int n = graph.node_count();
  const std::vector<int> node = inverse(rank);
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (int r = 0; r < n; ++r)
    for (auto k = graph.first[node[r]]; k < graph.first[node[r] + 1]; ++k)
      for (int below = rank[graph.neighbour[k]]; below >= 0 && below < r;) {
        const int next = std::exchange(ancestor[below], r);
        if (next < 0) parent[below] = r;
        below = next;
      }
  return parent;
}

std::vector<int> mended_order(const BlockGraph& graph, const std::vector<int>& rank, const std::vector<int>& parent,
                              double most) {
  const int n = graph.node_count();
  const std::vector<Joint> joints = edges_between_branches(graph, rank, parent);
  std::vector<std::vector<int>> joints_of(n);
  for (int j = 0; j < int(joints.size()); ++j)
    for (const int end : {joints[j].low, joints[j].high}) joints_of[end].push_back(j);

  // Selects the nodes to move, so that every edge between branches has a moved end. The node with the most uncovered
  // edges (edges without a moved end) is moved first.
  std::vector<int> open(n), moved_to(n, -1);
  std::priority_queue<std::pair<int, int>> next;  // for each node: number of its uncovered edges, and -rank
  for (int r = 0; r < n; ++r)
    if ((open[r] = int(joints_of[r].size())) > 0) next.emplace(open[r], -r);
  std::vector<char> covered(joints.size(), 0);
  int moved = 0;
  while (!next.empty()) {
    const int count = next.top().first, r = -next.top().second;
    next.pop();
    if (count != open[r] || open[r] == 0) {
      if (open[r] > 0) next.emplace(open[r], -r);
      continue;
    }
    if (++moved > most * n) return {};
    for (const int j : joints_of[r]) {
      if (std::exchange(covered[j], 1)) continue;
      --open[joints[j].low], --open[joints[j].high];
      moved_to[r] = std::max(moved_to[r], joints[j].joined_at);
    }
  }

  std::vector<std::vector<int>> before(n + 1);
  for (int r = 0; r < n; ++r)
    if (moved_to[r] >= 0) before[moved_to[r]].push_back(r);
  const std::vector<int> node = inverse(rank);
  std::vector<int> order;
  order.reserve(n);
  for (int r = 0; r <= n; ++r) {
    for (const int m : before[r]) order.push_back(node[m]);
    if (r < n && moved_to[r] < 0) order.push_back(node[r]);
  }
  return order;
}

}  // namespace limber
