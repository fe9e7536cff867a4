// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/crossings.h"

#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/mesh/predicates.h"

using namespace limber;

namespace {

using Pairs = std::vector<std::array<int, 2>>;

Pairs crossings(std::initializer_list<std::array<double, 3>> places,
                std::initializer_list<std::array<int, 3>> triangles) {
  Eigen::MatrixX3d V(places.size(), 3);
  Eigen::MatrixX3i F(triangles.size(), 3);
  int row = 0;
  for (const auto& p : places) V.row(row++) << p[0], p[1], p[2];
  row = 0;
  for (const auto& f : triangles) F.row(row++) << f[0], f[1], f[2];
  return crossing_pairs(V, F);
}

}  // namespace

TEST_CASE("crossings: the side of a point is exact where rounding would decide otherwise") {
  // Tests points in the plane whose coordinates are not exact in binary, then points just off a plane.
  const std::array<double, 3> a{0.1, 0.2, 0.3}, b{1.1, 0.7, -0.4}, c{-0.3, 0.9, 2.2};
  CHECK(side_3d(a, b, c, a) == 0);
  CHECK(side_3d(a, b, c, c) == 0);
  CHECK(side_3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, 1e-300}) == 1);
  CHECK(side_3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.5, -1e-300}) == -1);
  // On the line y = x far from the origin, one unit in the last place decides the side.
  const double far = 1e8, next = std::nextafter(far, 2e8);
  CHECK(side_2d({0, 0}, {far, far}, {far / 3, far / 3}) == 0);
  CHECK(side_2d({0, 0}, {far, far}, {far, next}) == 1);
  CHECK(side_2d({0, 0}, {far, far}, {next, far}) == -1);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> step(0, 40);
  int flat = 0;
  for (int i = 0; i < 20000; ++i) {
    // The positions near (0.5, 0.5, 0.5) lie on a grid of one unit in the last place. Their tets are nearly always too
    // flat for rounded arithmetic.
    std::array<std::array<double, 3>, 4> p;
    std::array<std::array<long, 3>, 4> whole;
    for (int k = 0; k < 4; ++k)
      for (int axis = 0; axis < 3; ++axis)
        whole[k][axis] = step(random), p[k][axis] = 0.5 + std::ldexp(double(whole[k][axis]), -53);
    long u[3], v[3], w[3];
    for (int axis = 0; axis < 3; ++axis)
      u[axis] = whole[1][axis] - whole[0][axis], v[axis] = whole[2][axis] - whole[0][axis],
      w[axis] = whole[3][axis] - whole[0][axis];
    const long det =
        (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
    const int side = det > 0 ? 1 : det < 0 ? -1 : 0;
    flat += side == 0;
    CHECK(side_3d(p[0], p[1], p[2], p[3]) == side);
    CHECK(side_3d(p[1], p[0], p[2], p[3]) == -side);
  }
  CHECK(flat > 0);
}

TEST_CASE("crossings: triangles that pierce, touch or lie upon each other cross, neighbours and strangers do not") {
  const std::initializer_list<std::array<int, 3>> two = {{0, 1, 2}, {3, 4, 5}};
  // An edge pierces the first triangle.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {5, 5, 1}}, two) == Pairs{{0, 1}});
  // A corner touches the first triangle.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 1}, {2, 2, 1}}, two) == Pairs{{0, 1}});
  // The triangles lie in one plane and overlap.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, two) == Pairs{{0, 1}});
  // The triangles lie in one plane, side by side.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {3, 3, 0}, {4, 3, 0}, {3, 4, 0}}, two).empty());
  // The second triangle passes just above the first.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1e-12}, {1, 1, 1}, {5, 5, 1}}, two).empty());
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {9, 9, 9}}, {{0, 1, 2}, {0, 1, 3}}).empty());  // an edge is shared
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}) ==
        Pairs{{0, 1}});  // the triangles share an edge and are folded flat onto each other
  // The triangles share an edge and are unfolded flat.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}).empty());
  // The triangles share one corner.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {-1, 0, 1}, {-1, 0, -1}}, {{0, 1, 2}, {0, 3, 4}}).empty());
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 1, 1}, {2, 1, -1}}, {{0, 1, 2}, {0, 3, 4}}) == Pairs{{0, 1}});
  // The two faces are the same triangle.
  CHECK(crossings({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {1, 2, 0}}) == Pairs{{0, 1}});
  CHECK(crossings({}, {}).empty());
}

TEST_CASE(
    "crossings: of many triangles, small and large, each pair is found once, as by asking every pair, with one thread "
    "and two") {
  std::mt19937 random(9);
  const auto any = [&](double most) { return std::uniform_real_distribution<double>(-most, most)(random); };
  constexpr int kCount = 400;
  Eigen::MatrixX3d V(3 * kCount, 3);
  Eigen::MatrixX3i F(kCount, 3);
  for (int t = 0; t < kCount; ++t) {
    const Eigen::RowVector3d centre(any(30), any(30), any(30));
    const double size = t % 50 == 0 ? 40 : 6;
    for (int i = 0; i < 3; ++i) {
      V.row(3 * t + i) = centre + Eigen::RowVector3d(any(size), any(size), any(size));
      F(t, i) = 3 * t + i;
    }
  }
  Pairs expected;
  for (int a = 0; a < kCount; ++a)
    for (int b = a + 1; b < kCount; ++b) {
      Eigen::MatrixX3i two(2, 3);
      two << F.row(a), F.row(b);
      if (!crossing_pairs(V, two).empty()) expected.push_back({a, b});
    }
  CHECK(expected.size() > 100);
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    CHECK(crossing_pairs(V, F) == expected);
  }
}
