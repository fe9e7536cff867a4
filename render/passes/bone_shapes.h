// SPDX-License-Identifier: AGPL-3.0-or-later
// The solids that represent bones in pictures, for a bone of length 1. The y axis runs along the bone from head to
// tail, the x and z axes across it.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "render/scene/scene.h"

namespace limber::render {

struct BoneSolid {
  struct Edge {
    int from, to;
    std::array<int, 2> faces;
    bool smooth;  // true: an edge of the cylinder's round side, drawn only where it is part of the outline
  };
  std::vector<glm::dvec3> points;  // corners of the solid; the first two are the bone's head and tail
  // For each face, indices of its corners; faces are planar, convex, counter-clockwise from outside.
  std::vector<std::vector<int>> faces;
  std::vector<Edge> edges;
};

// Returns the solid of a shape; null for Stick and None, which have no solid.
const BoneSolid* solid_of(BoneShape shape);

// Returns half the width of the shape at position `t` [0, 1] from head to tail, for a bone of length 1.
double half_width_at(BoneShape shape, double t);

}  // namespace limber::render
