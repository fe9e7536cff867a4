// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the pairs of triangles that cross, or touch elsewhere than in their shared corners and edges, by CGAL's boxes
// and exact predicates. Unlike CGAL's own self_intersections, this also works for surfaces that are no manifolds: parts
// of a body may meet in an edge.
#pragma once

#include <array>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <Eigen/Core>

namespace limber::test {

inline std::vector<std::array<int, 2>> crossings_by_cgal(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, int>;
  const auto point = [&](int v) { return Kernel::Point_3(V(v, 0), V(v, 1), V(v, 2)); };
  const auto triangle = [&](int f) { return Kernel::Triangle_3(point(F(f, 0)), point(F(f, 1)), point(F(f, 2))); };
  std::vector<Box> boxes;
  for (int f = 0; f < F.rows(); ++f) boxes.emplace_back(triangle(f).bbox(), f);

  std::vector<std::array<int, 2>> crossings;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& one, const Box& two) {
    const int a = one.info(), b = two.info();
    std::vector<int> common, of_a, of_b;
    for (const int v : F.row(a)) ((F.row(b).array() == v).any() ? common : of_a).push_back(v);
    for (const int v : F.row(b))
      if ((F.row(a).array() != v).all()) of_b.push_back(v);
    bool cross = true;  // stays true if both triangles have the same corners
    if (common.empty()) cross = CGAL::do_intersect(triangle(a), triangle(b));
    if (common.size() == 1)
      cross = CGAL::do_intersect(triangle(a), Kernel::Segment_3(point(of_b[0]), point(of_b[1]))) ||
              CGAL::do_intersect(triangle(b), Kernel::Segment_3(point(of_a[0]), point(of_a[1])));
    if (common.size() == 2) {
      const auto p = point(common[0]), q = point(common[1]), r = point(of_a[0]), s = point(of_b[0]);
      cross = CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
    }
    if (cross) crossings.push_back({std::min(a, b), std::max(a, b)});
  });
  std::sort(crossings.begin(), crossings.end());
  return crossings;
}

}  // namespace limber::test
