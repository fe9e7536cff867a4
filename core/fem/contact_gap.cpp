// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/contact_gap.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/parallel.h"
#include "core/deform/box_bins.h"
#include "core/deform/nearest_in_triangle.h"

namespace limber {

namespace {

constexpr int kBin = 8;           // number of cells along the edge of a bin in the search for near triangles
constexpr double kFacing = -0.3;  // two normals face each other if the cosine of their angle is below this

glm::dvec3 at(const Eigen::MatrixX3d& V, int i) { return {V(i, 0), V(i, 1), V(i, 2)}; }

// Returns the triangles' bounding boxes, rounded outwards to whole cells.
std::vector<VoxelRange> boxes_of(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F, double cell_mm) {
  std::vector<VoxelRange> boxes(F.rows());
  for (int f = 0; f < F.rows(); ++f) {
    const glm::dvec3 a = at(V, F(f, 0)) / cell_mm, b = at(V, F(f, 1)) / cell_mm, c = at(V, F(f, 2)) / cell_mm;
    boxes[f] = {glm::ivec3(glm::floor(glm::min(a, glm::min(b, c)))),
                glm::ivec3(glm::ceil(glm::max(a, glm::max(b, c))))};
  }
  return boxes;
}

}  // namespace

std::vector<double> contact_gaps(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F,
                                 double apart_mm, double reach_mm) {
  const auto normal_of = [&](int f) {
    return glm::cross(at(V, F(f, 1)) - at(V, F(f, 0)), at(V, F(f, 2)) - at(V, F(f, 0)));
  };
  std::vector<glm::dvec3> normal(V.rows(), glm::dvec3(0));
  for (int f = 0; f < F.rows(); ++f)
    for (int i = 0; i < 3; ++i) normal[F(f, i)] += normal_of(f);
  // Bins as wide as the search or as the triangles: so the cost is the same in every unit of length.
  double edges = 0;
  for (int f = 0; f < F.rows(); ++f) edges += glm::distance(at(V, F(f, 0)), at(V, F(f, 1)));
  const double cell_mm = std::max({reach_mm, edges / std::max<double>(F.rows(), 1), 1e-30}) / kBin;
  const BoxBins bins(boxes_of(V, F, cell_mm), kBin);
  const int reach = int(std::ceil(reach_mm / cell_mm));
  std::vector<double> gap(V.rows(), INFINITY);
  parallel_for(V.rows(), 256, [&](std::int64_t begin, std::int64_t end) {
    std::vector<int> near;
    for (int i = int(begin); i < int(end); ++i) {
      if (normal[i] == glm::dvec3(0)) continue;  // the node is inside the mesh
      const glm::dvec3 p = at(V, i), out = glm::normalize(normal[i]);
      const glm::dvec3 cell = p / cell_mm;
      bins.meeting({glm::ivec3(glm::floor(cell)) - reach, glm::ivec3(glm::ceil(cell)) + reach}, near);
      for (int f : near) {
        if ((F.row(f).array() == i).any()) continue;  // the node is a corner of the triangle
        const glm::dvec3 across = normal_of(f);
        if (glm::dot(out, across) > kFacing * glm::length(across)) continue;
        if (glm::distance(at(rest, i), (at(rest, F(f, 0)) + at(rest, F(f, 1)) + at(rest, F(f, 2))) / 3.0) < apart_mm)
          continue;
        const glm::dvec3 s = nearest_in_triangle(p, at(V, F(f, 0)), at(V, F(f, 1)), at(V, F(f, 2)));
        const glm::dvec3 off = s.x * at(V, F(f, 0)) + s.y * at(V, F(f, 1)) + s.z * at(V, F(f, 2)) - p;
        if (glm::dot(off, out) >= 0) gap[i] = std::min(gap[i], glm::length(off));
      }
    }
  });
  for (double& mm : gap)
    if (mm >= reach_mm) mm = INFINITY;
  return gap;
}

std::optional<ContactGap> contact_gap(const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& V,
                                      const Eigen::MatrixX3i& F, double apart_mm, double reach_mm) {
  std::vector<double> gap = contact_gaps(rest, V, F, apart_mm, reach_mm);
  std::erase_if(gap, [](double mm) { return std::isinf(mm); });
  if (gap.empty()) return std::nullopt;
  std::sort(gap.begin(), gap.end());
  return ContactGap{gap.front(), gap[gap.size() / 2], std::ssize(gap)};
}

}  // namespace limber
