// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/multigrid.h"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"

using namespace limber;

namespace {
// Makes a box of cells of which some are left out at random. Its outer faces are held at 0.
CellGraph box_graph(const glm::ivec3& size, const glm::dvec3& spacing, double share_left_out, unsigned key) {
  std::mt19937 random(key);
  std::vector<int> number(size.x * size.y * size.z, -1);
  auto at = [&](const glm::ivec3& v) { return v.x + size.x * (v.y + size.y * v.z); };
  std::vector<bool> present(number.size());
  for (size_t i = 0; i < present.size(); ++i) present[i] = random() >= share_left_out * 4294967296.0;
  CellGraph graph;
  graph.spacing = spacing;
  for (int colour = 0; colour < 2; ++colour) {
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          if (((x + y + z) & 1) == colour && present[at({x, y, z})]) {
            number[at({x, y, z})] = static_cast<int>(graph.position.size());
            graph.position.push_back({x, y, z});
          }
    if (colour == 0) graph.red_count = static_cast<int>(graph.position.size());
  }
  graph.first.push_back(0);
  for (const auto& p : graph.position) {
    float diagonal = 0;
    for (int direction = 0; direction < 6; ++direction) {
      const int axis = direction / 2;
      const float g = static_cast<float>(1 / (spacing[axis] * spacing[axis]));
      glm::ivec3 q(p);
      q[axis] += direction & 1 ? 1 : -1;
      diagonal += g;
      if (q[axis] < 0 || q[axis] >= size[axis]) continue;  // outside the box, where the value is held at 0
      if (number[at(q)] < 0) {
        diagonal -= 0.9f * g;
        continue;
      }
      graph.neighbour.push_back(number[at(q)]);
      graph.conductance.push_back(g);
    }
    graph.diagonal.push_back(diagonal);
    graph.first.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

double relative_residual(const CellGraph& graph, const ZeroedVector<float>& b, const ZeroedVector<float>& x, int lanes,
                         int lane) {
  double rr = 0, bb = 0;
  for (std::int64_t i = 0; i < graph.size(); ++i) {
    double r = b[i * lanes + lane] - double(graph.diagonal[i]) * x[i * lanes + lane];
    for (int k = graph.first[i]; k < graph.first[i + 1]; ++k)
      r += double(graph.conductance[k]) * x[std::int64_t{graph.neighbour[k]} * lanes + lane];
    rr += r * r;
    bb += double(b[i * lanes + lane]) * b[i * lanes + lane];
  }
  return std::sqrt(rr / bb);
}

ZeroedVector<float> random_sources(std::int64_t count) {
  std::mt19937 random(5);
  ZeroedVector<float> b(count);
  for (float& value : b) value = random() % 16 == 0 ? 1.0f : 0.0f;
  return b;
}
}  // namespace

TEST_CASE("multigrid: the residual it states is the residual, for any number of right sides") {
  for (int lanes = 1; lanes <= Multigrid::kMostLanes; ++lanes) {
    const CellGraph graph = box_graph({21, 18, 25}, glm::dvec3(1), 0.2, lanes);
    const ZeroedVector<float> b = random_sources(graph.size() * lanes);
    ZeroedVector<float> x(b.size());
    const MultigridReport report = Multigrid(graph).solve(b, x, lanes, 1e-5, 100);
    CHECK(report.residual <= 1e-5);
    double worst = 0;
    for (int lane = 0; lane < lanes; ++lane) worst = std::max(worst, relative_residual(graph, b, x, lanes, lane));
    CHECK(worst < 2e-5);
  }
}

TEST_CASE("multigrid: iterations stay few when the body grows and when voxels are flat or long") {
  for (const auto& [size, spacing] : std::vector<std::pair<glm::ivec3, glm::dvec3>>{{{16, 16, 16}, glm::dvec3(1)},
                                                                                    {{64, 64, 64}, glm::dvec3(1)},
                                                                                    {{40, 40, 40}, {0.5, 3, 20}},
                                                                                    {{60, 60, 20}, {0.28, 0.28, 1}}}) {
    const CellGraph graph = box_graph(size, spacing, 0.05, 3);
    const ZeroedVector<float> b = random_sources(graph.size());
    ZeroedVector<float> x(b.size());
    const MultigridReport report = Multigrid(graph).solve(b, x, 1, 1e-5, 100);
    CHECK(report.residual <= 1e-5);
    CHECK(report.iterations <= 16);
  }
}

TEST_CASE("multigrid: 1, 2 and 4 threads give the same bits") {
  const CellGraph graph = box_graph({40, 30, 35}, glm::dvec3(1), 0.3, 9);
  const ZeroedVector<float> b = random_sources(graph.size() * 3);
  std::vector<ZeroedVector<float>> results;
  for (int threads : {1, 2, 4}) {
    const ThreadCount limit(threads);
    ZeroedVector<float> x(b.size());
    Multigrid(graph).solve(b, x, 3, 1e-6, 100);
    results.push_back(x);
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}
