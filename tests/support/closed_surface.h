// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures a surface of triangles: the edges that it leaves open, and the volume that it encloses.
#pragma once

#include <map>
#include <utility>

#include "core/mesh/surface.h"

namespace limber::test {

// Returns the number of directed edges that no triangle passes in the other direction, or -1 if two triangles pass an
// edge in the same direction. A closed surface whose triangles agree on the outside has none.
inline int open_edges(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> passes;
  for (const glm::ivec3& f : mesh.F)
    for (int i = 0; i < 3; ++i) ++passes[{f[i], f[(i + 1) % 3]}];
  int open = 0;
  for (const auto& [edge, count] : passes) {
    if (count > 1) return -1;
    open += !passes.contains({edge.second, edge.first});
  }
  return open;
}

// Returns the enclosed volume by the divergence theorem: positive if the triangles are counter-clockwise from outside.
inline double volume_inside(const TriangleMesh& mesh) {
  double sum = 0;
  for (const glm::ivec3& f : mesh.F) sum += glm::dot(mesh.V[f.x], glm::cross(mesh.V[f.y], mesh.V[f.z])) / 6;
  return sum;
}

}  // namespace limber::test
