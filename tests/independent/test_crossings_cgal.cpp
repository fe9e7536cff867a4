// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the program's crossings of a surface with those that CGAL finds.
#include "core/mesh/crossings.h"

#include <cmath>
#include <map>
#include <random>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <doctest/doctest.h>

using namespace limber;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Pairs = std::vector<std::array<int, 2>>;

struct Surface {
  Eigen::MatrixX3d V;
  Eigen::MatrixX3i F;
};

// Returns a closed tube along x, with `around` vertices in each of its `along` circles.
Surface tube(int around, int along) {
  Surface s;
  s.V.resize(around * along + 2, 3);
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * M_PI * (i + 0.5 * (j % 2)) / around;
      s.V.row(j * around + i) << 200.0 * j / (along - 1) - 100, 30 * std::cos(angle), 30 * std::sin(angle);
    }
  s.V.row(around * along) << -110, 0, 0;
  s.V.row(around * along + 1) << 110, 0, 0;
  std::vector<Eigen::RowVector3i> faces;
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around, last = (along - 1) * around;
    faces.push_back({around * along, next, i});
    faces.push_back({around * along + 1, last + i, last + next});
    for (int j = 0; j + 1 < along; ++j) {
      const int a = j * around, b = a + around, shift = j % 2;
      if (shift) faces.insert(faces.end(), {{a + i, b + next, b + i}, {a + i, a + next, b + next}});
      else faces.insert(faces.end(), {{a + i, a + next, b + i}, {a + next, b + next, b + i}});
    }
  }
  s.F.resize(faces.size(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) s.F.row(f) = faces[f];
  return s;
}

Pairs by_cgal(const Surface& s) {
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertex;
  for (const auto& p : s.V.rowwise()) vertex.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
  for (const auto& f : s.F.rowwise()) {
    const auto face = mesh.add_face(vertex[f[0]], vertex[f[1]], vertex[f[2]]);
    REQUIRE(face != Mesh::null_face());
  }
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(found));
  Pairs pairs;
  for (const auto& [a, b] : found) pairs.push_back({std::min<int>(a, b), std::max<int>(a, b)});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// Returns the tube bent at its middle by an angle, as linear blend skinning bends it.
Surface bent(double degrees) {
  Surface s = tube(24, 41);
  for (Eigen::Index i = 0; i < s.V.rows(); ++i) {
    const double x = s.V(i, 0), y = s.V(i, 1), share = 1 / (1 + std::exp(-x / 8)), angle = degrees * M_PI / 180;
    s.V(i, 0) = (1 - share) * x + share * (std::cos(angle) * x - std::sin(angle) * y);
    s.V(i, 1) = (1 - share) * y + share * (std::sin(angle) * x + std::cos(angle) * y);
  }
  return s;
}

}  // namespace

TEST_CASE("crossings: CGAL finds the same pairs in a tube bent more and more") {
  for (const double degrees : {0, 60, 90, 120, 150, 175}) {
    CAPTURE(degrees);
    const Surface s = bent(degrees);
    const Pairs expected = by_cgal(s);
    CHECK(crossing_pairs(s.V, s.F) == expected);
    CHECK(expected.empty() == (degrees < 60));
  }
}

TEST_CASE("crossings: CGAL finds the same pairs in a tube whose places are shaken, and in one on a coarse lattice") {
  for (int seed = 0; seed < 12; ++seed) {
    CAPTURE(seed);
    Surface s = bent(15.0 * seed);
    std::mt19937 random(seed);
    const double most = 0.3 * (1 << seed % 6);
    for (Eigen::Index i = 0; i < s.V.rows(); ++i)
      for (int k = 0; k < 3; ++k) s.V(i, k) += std::uniform_real_distribution<double>(-most, most)(random);
    // Rounding makes corners coincide, flattens triangles, and moves triangles into shared planes.
    if (seed % 3 == 2) s.V = (s.V / 4).array().round() * 4;
    // CGAL omits triangles without area, which cannot be crossed.
    const Pairs expected = by_cgal(s);
    if (seed % 3 != 2) CHECK(crossing_pairs(s.V, s.F) == expected);
    else CHECK(crossing_pairs(s.V, s.F).empty() == expected.empty());
  }
}
