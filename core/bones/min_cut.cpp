// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/min_cut.h"

#include <algorithm>
#include <deque>
#include <limits>

namespace limber {

namespace {

template <int Edges>
class TwoTrees {
 public:
  explicit TwoTrees(CutGraph<Edges>&& graph) : graph_(std::move(graph)), tree_(graph_.terminal.size()) {
    for (std::int32_t i = 0; i < count(); ++i) {
      if (graph_.terminal[i] == 0) continue;
      tree_[i] = {graph_.terminal[i] > 0 ? kSource : kSink, kTerminal, 1, 0, true};
      active_.push_back(i);
    }
  }

  std::vector<std::uint8_t> run() && {
    while (!active_.empty()) {
      const std::int32_t i = active_.front();
      if (tree_[i].side == kFree) {
        deactivate_front();
        continue;
      }
      if (const Meeting meeting = grow(i); meeting.from_source >= 0) {
        ++time_;
        augment(meeting);
        adopt();
      } else {
        deactivate_front();
      }
    }
    std::vector<std::uint8_t> is_source(tree_.size());
    for (std::size_t i = 0; i < tree_.size(); ++i) is_source[i] = tree_[i].side == kSource;
    return is_source;
  }

 private:
  enum Side : std::int8_t { kFree, kSource, kSink };
  // Values of Node::parent that are not edge numbers: the parent is the source or sink itself, or there is no parent.
  static constexpr std::int8_t kTerminal = Edges, kOrphan = Edges + 1;

  struct Node {
    Side side = kFree;
    std::int8_t parent = kOrphan;  // number (0 to Edges - 1) of the edge that leads to the parent, kTerminal or kOrphan
    std::int32_t distance = 0;     // number of edges from the source or sink when it was last computed, at `time`
    std::int64_t time = 0;
    bool is_active = false;
  };
  // An edge that joins the two search trees: edge number `edge` of the node `from_source`, which is in the source's
  // tree.
  struct Meeting {
    std::int32_t from_source = -1;
    int edge = 0;
  };

  static constexpr int back(int edge) { return Edges - 1 - edge; }

  std::int32_t count() const { return static_cast<std::int32_t>(tree_.size()); }
  void activate(std::int32_t i) {
    if (tree_[i].is_active) return;
    tree_[i].is_active = true;
    active_.push_back(i);
  }
  void deactivate_front() {
    tree_[active_.front()].is_active = false;
    active_.pop_front();
  }
  // Returns the remaining capacity of edge k of node i: away from the source if the node is in the source's tree,
  // towards the sink if it is in the sink's tree.
  std::int32_t outward(std::int32_t i, int k) const {
    return tree_[i].side == kSource ? graph_.capacity[i][k] : graph_.capacity[graph_.neighbour[i][k]][back(k)];
  }

  Meeting grow(std::int32_t i) {
    for (int k = 0; k < Edges; ++k) {
      const std::int32_t n = graph_.neighbour[i][k];
      if (n < 0 || outward(i, k) <= 0) continue;
      if (tree_[n].side == kFree) {
        tree_[n].side = tree_[i].side;
        tree_[n].parent = static_cast<std::int8_t>(back(k));
        tree_[n].distance = tree_[i].distance + 1;
        tree_[n].time = tree_[i].time;
        activate(n);
      } else if (tree_[n].side != tree_[i].side) {
        return tree_[i].side == kSource ? Meeting{i, k} : Meeting{n, back(k)};
      } else if (tree_[n].time <= tree_[i].time && tree_[n].distance > tree_[i].distance + 1) {
        tree_[n].parent = static_cast<std::int8_t>(back(k));
        tree_[n].distance = tree_[i].distance + 1;
        tree_[n].time = tree_[i].time;
      }
    }
    return {};
  }

  std::int32_t bottleneck(std::int32_t i) const {
    std::int32_t least = std::numeric_limits<std::int32_t>::max();
    const bool is_source = tree_[i].side == kSource;
    for (; tree_[i].parent != kTerminal; i = graph_.neighbour[i][tree_[i].parent]) {
      const int k = tree_[i].parent;
      least = std::min(least, is_source ? graph_.capacity[graph_.neighbour[i][k]][back(k)] : graph_.capacity[i][k]);
    }
    return std::min(least, std::abs(graph_.terminal[i]));
  }
  void push(std::int32_t i, std::int32_t flow) {
    const bool is_source = tree_[i].side == kSource;
    while (tree_[i].parent != kTerminal) {
      const int k = tree_[i].parent;
      const std::int32_t p = graph_.neighbour[i][k];
      std::int32_t& down = is_source ? graph_.capacity[p][back(k)] : graph_.capacity[i][k];
      std::int32_t& backwards = is_source ? graph_.capacity[i][k] : graph_.capacity[p][back(k)];
      down -= flow;
      backwards += flow;
      if (down == 0) orphan(i);
      i = p;
    }
    graph_.terminal[i] += is_source ? -flow : flow;
    if (graph_.terminal[i] == 0) orphan(i);
  }
  void orphan(std::int32_t i) {
    tree_[i].parent = kOrphan;
    orphans_.push_back(i);
  }
  void augment(const Meeting& meeting) {
    const std::int32_t i = meeting.from_source, n = graph_.neighbour[i][meeting.edge];
    const std::int32_t flow = std::min({graph_.capacity[i][meeting.edge], bottleneck(i), bottleneck(n)});
    graph_.capacity[i][meeting.edge] -= flow;
    graph_.capacity[n][back(meeting.edge)] += flow;
    push(i, flow);
    push(n, flow);
  }

  // Returns the number of edges from a node to its terminal (source or sink), or -1 if the path there ends at an
  // orphan, a node without parent. Stores the distances of the nodes on the path.
  std::int32_t distance_to_terminal(std::int32_t i) {
    std::int32_t steps = 0, at = i;
    for (;; ++steps, at = graph_.neighbour[at][tree_[at].parent]) {
      if (tree_[at].time == time_) {
        steps += tree_[at].distance;
        break;
      }
      if (tree_[at].parent == kOrphan) return -1;
      if (tree_[at].parent == kTerminal) {
        tree_[at].time = time_;
        tree_[at].distance = 1;
        steps += 1;
        break;
      }
    }
    std::int32_t left = steps;
    for (at = i; tree_[at].time != time_; at = graph_.neighbour[at][tree_[at].parent]) {
      tree_[at].time = time_;
      tree_[at].distance = left--;
    }
    return steps;
  }
  void adopt() {
    while (!orphans_.empty()) {
      const std::int32_t i = orphans_.front();
      orphans_.pop_front();
      int best = -1;
      std::int32_t nearest = std::numeric_limits<std::int32_t>::max();
      for (int k = 0; k < Edges; ++k) {
        const std::int32_t n = graph_.neighbour[i][k];
        if (n < 0 || tree_[n].side != tree_[i].side || tree_[n].parent == kOrphan || outward(n, back(k)) <= 0) continue;
        const std::int32_t d = distance_to_terminal(n);
        if (d >= 0 && d < nearest) nearest = d, best = k;
      }
      if (best >= 0) {
        tree_[i].parent = static_cast<std::int8_t>(best);
        tree_[i].distance = nearest + 1;
        tree_[i].time = time_;
      } else {
        set_free(i);
      }
    }
  }
  void set_free(std::int32_t i) {
    for (int k = 0; k < Edges; ++k) {
      const std::int32_t n = graph_.neighbour[i][k];
      if (n < 0 || tree_[n].side != tree_[i].side) continue;
      if (outward(n, back(k)) > 0) activate(n);
      if (tree_[n].parent == back(k)) orphan(n);
    }
    tree_[i].side = kFree;
    tree_[i].parent = kOrphan;
  }

  CutGraph<Edges> graph_;
  std::vector<Node> tree_;
  std::deque<std::int32_t> active_, orphans_;
  std::int64_t time_ = 0;
};

}  // namespace

template <int Edges>
std::vector<std::uint8_t> min_cut(CutGraph<Edges> graph) {
  return TwoTrees<Edges>(std::move(graph)).run();
}
template std::vector<std::uint8_t> min_cut(CutGraph<6> graph);
template std::vector<std::uint8_t> min_cut(CutGraph<26> graph);

}  // namespace limber
