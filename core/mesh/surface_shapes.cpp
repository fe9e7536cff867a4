// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <unordered_map>

#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
constexpr double kLeastExtent = 0.001, kMostExtent = 1e6;  // a shape with a smaller or larger side is refused, mm
// Least number of sides of the polygon that approximates a circle. With 32 sides its area is 0.6 % too small.
constexpr int kLeastSides = 32;

void check_extent(const char* what, double extent) {
  if (!(extent >= kLeastExtent && extent <= kMostExtent))
    throw Error(std::string("the ") + what + " of an obstacle is " + text_of(extent) + " mm", "obstacle",
                "use a value from 0.001 mm to 1 000 000 mm");
}

// A shape's surface is divided into squares, at least approximately, and each square into two triangles. Returns the
// edge length of the squares, mm, for which the triangles are within the limits of surface_shapes.h. The longest edges
// of the triangles are the diagonals of the squares.
//   extent     largest extent of the shape, mm
//   triangles  returns the number of the shape's triangles for a given edge length
double side_for(double extent, const std::function<std::int64_t(double)>& triangles) {
  double side = std::min(extent / 10, kLongestShapeEdge) / std::numbers::sqrt2;
  while (triangles(side) > static_cast<std::int64_t>(kMostShapeTriangles)) side *= 1.02;
  return side;
}

std::int64_t parts(double extent, double side) {
  // Subtracts 1e-9 so that a quotient that is a whole number is not rounded up because of a rounding error.
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(extent / side - 1e-9)));
}

// ---- Box and plane: faces of a lattice of count.x by count.y by count.z cells

class LatticeFaces {
 public:
  LatticeFaces(const glm::dvec3& size, const glm::i64vec3& count) : size_(size), count_(count) {}

  // Adds the face of the lattice perpendicular to `axis`: at its end (outside towards + axis) or at its start (towards
  // - axis).
  void add_face(int axis, bool at_end) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (std::int64_t i = 0; i < count_[u]; ++i)
      for (std::int64_t j = 0; j < count_[v]; ++j) {
        const auto corner = [&](int di, int dj) {
          glm::i64vec3 at(0);
          at[axis] = at_end ? count_[axis] : 0;
          at[u] = i + di;
          at[v] = j + dj;
          return vertex(at);
        };
        const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
        if (at_end) mesh_.F.insert(mesh_.F.end(), {{a, b, c}, {a, c, d}});
        else mesh_.F.insert(mesh_.F.end(), {{a, c, b}, {a, d, c}});
      }
  }

  TriangleMesh take() { return std::move(mesh_); }

 private:
  int vertex(const glm::i64vec3& at) {
    const std::int64_t key = (at.x * (count_.y + 1) + at.y) * (count_.z + 1) + at.z;
    const auto [found, is_new] = vertices_.try_emplace(key, static_cast<int>(mesh_.V.size()));
    // (at + at - count) / count has exactly opposite values at opposite vertices, so the shape is exactly symmetric.
    if (is_new) mesh_.V.push_back(size_ * 0.5 * glm::dvec3(at + at - count_) / glm::dvec3(count_));
    return found->second;
  }

  glm::dvec3 size_;
  glm::i64vec3 count_;
  TriangleMesh mesh_;
  std::unordered_map<std::int64_t, int> vertices_;
};

// ---- Cylinder: circles, each joined to the next one

struct Circle {
  double radius, z;
  int sides;  // number of vertices; 1 for the centre of an end
};

// Joins circle a, with the vertices [a, a + na), to circle b, with the vertices [b, b + nb). Seen along a circle in the
// direction of ascending numbers, and with b above a, the outside is on the right.
void join_circles(int a, int na, int b, int nb, std::vector<glm::ivec3>& F) {
  const int steps_a = na > 1 ? na : 0, steps_b = nb > 1 ? nb : 0;
  for (int i = 0, j = 0; i < steps_a || j < steps_b;) {
    // Steps along the circle for which the new edge between the two circles is shorter, judged by the angles of its
    // ends.
    const std::int64_t if_a = std::abs(std::int64_t{i + 1} * nb - std::int64_t{j} * na),
                       if_b = std::abs(std::int64_t{i} * nb - std::int64_t{j + 1} * na);
    const bool along_a = i < steps_a && (j == steps_b || if_a <= if_b);
    if (along_a) F.push_back({a + i, a + (i + 1) % na, b + j % nb}), ++i;
    else F.push_back({a + i % na, b + (j + 1) % nb, b + j % nb}), ++j;
  }
}

std::vector<Circle> circles_of(double radius, double length, CylinderEnds ends, double side) {
  const auto sides_of = [&](double r) { return 2 * std::numbers::pi * r / side; };
  // The number of sides is a multiple of four, so that the polygon reaches the circle along both axes.
  const int sides = std::max(kLeastSides, static_cast<int>((parts(2 * std::numbers::pi * radius, side) + 3) / 4 * 4));
  const std::int64_t rows = parts(length, side), rings = parts(radius, side);
  std::vector<Circle> end;  // circles on an end face, from its middle outwards, without the rim
  if (ends == CylinderEnds::Closed) {
    end.push_back({0, 0, 1});
    for (std::int64_t k = 1; k < rings; ++k) {
      const double r = radius * double(k) / double(rings);
      end.push_back({r, 0, std::clamp(static_cast<int>(std::ceil(sides_of(r))), 6, sides)});
    }
  }
  std::vector<Circle> circles;
  for (const Circle& circle : end) circles.push_back({circle.radius, -length / 2, circle.sides});
  for (std::int64_t k = 0; k <= rows; ++k)
    circles.push_back({radius, length / 2 * double(2 * k - rows) / double(rows), sides});
  for (auto circle = end.rbegin(); circle != end.rend(); ++circle)
    circles.push_back({circle->radius, length / 2, circle->sides});
  return circles;
}

// Returns the number of triangles that join each circle to the next one: one for each side of either circle.
std::int64_t triangles_between(const std::vector<Circle>& circles) {
  std::int64_t count = 0;
  for (std::size_t c = 0; c + 1 < circles.size(); ++c)
    for (const int sides : {circles[c].sides, circles[c + 1].sides}) count += sides > 1 ? sides : 0;
  return count;
}
}  // namespace

TriangleMesh box_surface(const glm::dvec3& size) {
  for (int axis = 0; axis < 3; ++axis) check_extent("size", size[axis]);
  const auto cells = [&](double side) {
    return glm::i64vec3(parts(size.x, side), parts(size.y, side), parts(size.z, side));
  };
  const double side = side_for(std::max({size.x, size.y, size.z}), [&](double s) {
    const glm::i64vec3 n = cells(s);
    return 4 * (n.x * n.y + n.y * n.z + n.z * n.x);
  });
  LatticeFaces faces(size, cells(side));
  for (int axis = 0; axis < 3; ++axis)
    for (const bool at_end : {false, true}) faces.add_face(axis, at_end);
  return faces.take();
}

TriangleMesh plane_surface(double width, double depth) {
  check_extent("width", width);
  check_extent("depth", depth);
  const auto cells = [&](double side) { return glm::i64vec3(parts(width, side), parts(depth, side), 1); };
  const double side = side_for(std::max(width, depth), [&](double s) { return 2 * cells(s).x * cells(s).y; });
  LatticeFaces faces({width, depth, 0}, cells(side));
  faces.add_face(2, true);
  return faces.take();
}

TriangleMesh cylinder_surface(double radius, double length, CylinderEnds ends) {
  check_extent("radius", radius);
  check_extent("length", length);
  const double side = side_for(std::max(2 * radius, length),
                               [&](double s) { return triangles_between(circles_of(radius, length, ends, s)); });
  TriangleMesh mesh;
  int before = 0, before_sides = 0;
  for (const Circle& circle : circles_of(radius, length, ends, side)) {
    const int first = static_cast<int>(mesh.V.size());
    for (int i = 0; i < circle.sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / circle.sides;
      mesh.V.push_back({circle.radius * std::cos(angle), circle.radius * std::sin(angle), circle.z});
    }
    if (before_sides > 0) join_circles(before, before_sides, first, circle.sides, mesh.F);
    before = first;
    before_sides = circle.sides;
  }
  return mesh;
}

}  // namespace limber
