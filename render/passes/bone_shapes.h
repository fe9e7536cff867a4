// SPDX-License-Identifier: AGPL-3.0-or-later
// The solids that bones are drawn as, for a bone of length 1: x and z across, y along it from head to tail.
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
    bool smooth;  // of a round side: seen only where it is the outline
  };
  std::vector<glm::dvec3> points;       // the first two are head and tail
  std::vector<std::vector<int>> faces;  // plane and convex, counter-clockwise from outside
  std::vector<Edge> edges;
};

// Null for what is no solid: sticks, nothing.
const BoneSolid* solid_of(BoneShape shape);

// How far the shape reaches to either side, `t` of the way from head to tail.
double half_width_at(BoneShape shape, double t);

}  // namespace limber::render
