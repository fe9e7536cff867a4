// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/max_flow.h"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {

struct Link {
  int a, slot_a, b, slot_b, capacity;
};

// The cheapest of all cuts, by trying each.
int least_cut(int nodes, const std::vector<Link>& links, unsigned sources, unsigned sinks) {
  int least = INT32_MAX;
  for (unsigned side = 0; side < 1u << nodes; ++side) {
    if ((side & sources) != sources || (side & sinks)) continue;
    int cost = 0;
    for (const Link& link : links)
      if ((side >> link.a & 1) != (side >> link.b & 1)) cost += link.capacity;
    least = std::min(least, cost);
  }
  return least;
}

}  // namespace

TEST_CASE("max flow: on random grids of 12 nodes no cut is cheaper") {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::vector<Link> links;
    MaxFlow flow(12);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) {
        const int here = x + 4 * y;
        if (x < 3) links.push_back({here, 1, here + 1, 0, int(random() % 9) + 1});
        if (y < 2) links.push_back({here, 3, here + 4, 2, int(random() % 9) + 1});
      }
    for (const Link& l : links) flow.connect(l.a, l.slot_a, l.b, l.slot_b, l.capacity);
    const unsigned sources = 1u << random() % 4, sinks = 1u << (8 + random() % 4);
    for (int n = 0; n < 12; ++n) {
      if (sources >> n & 1) flow.fix(n, MaxFlow::Side::Source);
      if (sinks >> n & 1) flow.fix(n, MaxFlow::Side::Sink);
    }
    const std::vector<bool> side = flow.source_side();
    int cost = 0;
    for (const Link& l : links) cost += side[l.a] != side[l.b] ? l.capacity : 0;
    CHECK(cost == least_cut(12, links, sources, sinks));
    for (int n = 0; n < 12; ++n) {
      if (sources >> n & 1) CHECK(side[n]);
      if (sinks >> n & 1) CHECK(!side[n]);
    }
  }
}
