// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/max_flow.h"

#include <algorithm>

namespace limber {

// Breadth first from all sources. False where no sink is reached any more.
bool MaxFlow::find_layers() {
  layer_.assign(edges_.size(), -1);
  reached_.clear();
  for (std::int32_t node = 0; node < std::ssize(side_); ++node)
    if (side_[node] == Side::Source) {
      layer_[node] = 0;
      reached_.push_back(node);
    }
  bool found = false;
  for (std::size_t i = 0; i < reached_.size(); ++i) {
    const std::int32_t node = reached_[i];
    if (side_[node] == Side::Sink) {
      found = true;
      continue;
    }
    for (const Edge& edge : edges_[node])
      if (edge.left > 0 && layer_[edge.to] < 0) {
        layer_[edge.to] = layer_[node] + 1;
        reached_.push_back(edge.to);
      }
  }
  return found;
}

// A blocking flow: from every source as much as the layers let through.
void MaxFlow::push_all() {
  next_.assign(edges_.size(), 0);
  std::vector<std::int32_t> way;
  for (std::int32_t source = 0; source < std::ssize(side_); ++source) {
    if (side_[source] != Side::Source) continue;
    way.assign(1, source);
    while (!way.empty()) {
      const std::int32_t node = way.back();
      if (side_[node] == Side::Sink) {
        std::int32_t least = INT32_MAX;
        for (std::size_t i = 0; i + 1 < way.size(); ++i) least = std::min(least, edges_[way[i]][next_[way[i]]].left);
        std::size_t keep = way.size();
        for (std::size_t i = way.size() - 1; i-- > 0;) {
          Edge& edge = edges_[way[i]][next_[way[i]]];
          edge.left -= least;
          edges_[edge.to][edge.back].left += least;
          if (edge.left == 0) keep = i + 1;
        }
        way.resize(keep);
        continue;
      }
      std::uint8_t& slot = next_[node];
      while (slot < 6 && !(edges_[node][slot].left > 0 && layer_[edges_[node][slot].to] == layer_[node] + 1)) ++slot;
      if (slot < 6) {
        way.push_back(edges_[node][slot].to);
        continue;
      }
      way.pop_back();
      if (!way.empty()) ++next_[way.back()];
    }
  }
}

std::vector<bool> MaxFlow::source_side() {
  while (find_layers()) push_all();
  std::vector<bool> source(edges_.size());
  for (std::size_t node = 0; node < source.size(); ++node) source[node] = layer_[node] >= 0;
  return source;
}

}  // namespace limber
