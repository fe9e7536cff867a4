// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/bone_shapes.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace limber::render {

namespace {

// Half the width of an octahedron, and the distance of its widest section from the bone's head, as fractions of the
// bone's length.
constexpr double kHalfWidth = 0.085, kWidestAt = 0.12;
constexpr double kRadius = 0.05;  // radius of a cylinder, as a fraction of the bone's length
// Number of sides of a cylinder. With 20 it looks round at any size in which bones are drawn.
constexpr int kSides = 20;

// Adds every edge of the solid's faces to the solid, once, with the two faces that share the edge.
void add_edges(BoneSolid& solid) {
  std::map<std::pair<int, int>, std::vector<int>> met;
  for (int f = 0; f < static_cast<int>(solid.faces.size()); ++f) {
    const std::vector<int>& face = solid.faces[static_cast<size_t>(f)];
    for (size_t i = 0; i < face.size(); ++i) met[std::minmax(face[i], face[(i + 1) % face.size()])].push_back(f);
  }
  for (const auto& [ends, faces] : met) solid.edges.push_back({ends.first, ends.second, {faces[0], faces[1]}, false});
}

BoneSolid octahedron() {
  BoneSolid solid{{{0, 0, 0},
                   {0, 1, 0},
                   {kHalfWidth, kWidestAt, 0},
                   {0, kWidestAt, kHalfWidth},
                   {-kHalfWidth, kWidestAt, 0},
                   {0, kWidestAt, -kHalfWidth}},
                  {{0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 2}, {1, 3, 2}, {1, 4, 3}, {1, 5, 4}, {1, 2, 5}},
                  {}};
  add_edges(solid);
  return solid;
}

BoneSolid cylinder() {
  BoneSolid solid{{{0, 0, 0}, {0, 1, 0}}, {}, {}};
  std::vector<int> low, high;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides, x = kRadius * std::cos(angle),
                 z = kRadius * std::sin(angle);
    solid.points.insert(solid.points.end(), {{x, 0, z}, {x, 1, z}});
    const int here = 2 + 2 * i, next = 2 + 2 * ((i + 1) % kSides);
    solid.faces.push_back({here, here + 1, next + 1, next});
    low.push_back(here);
    high.insert(high.begin(), here + 1);
  }
  solid.faces.push_back(low);
  solid.faces.push_back(high);
  add_edges(solid);
  // The edges along the cylinder's axis are smooth. Each runs from a point of the lower rim to the point above it.
  for (BoneSolid::Edge& edge : solid.edges) edge.smooth = edge.from % 2 == 0 && edge.to == edge.from + 1;
  return solid;
}

}  // namespace

const BoneSolid* solid_of(BoneShape shape) {
  static const BoneSolid kOctahedron = octahedron(), kCylinder = cylinder();
  switch (shape) {
    case BoneShape::Octahedron: return &kOctahedron;
    case BoneShape::Cylinder: return &kCylinder;
    case BoneShape::Stick:
    case BoneShape::None: break;
  }
  return nullptr;
}

double half_width_at(BoneShape shape, double t) {
  if (shape == BoneShape::Cylinder) return kRadius;
  return shape == BoneShape::Octahedron ? kHalfWidth * (t < kWidestAt ? t / kWidestAt : (1 - t) / (1 - kWidestAt)) : 0;
}

}  // namespace limber::render
