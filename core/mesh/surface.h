// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the surface of a body as triangles at the points where the share of tissue in a cell is one half [Gibson,
// Constrained elastic surface nets, MICCAI 1998]. Every cube of eight cell centres of which some are inside and some
// outside gets one vertex, at the mean of the points where the surface crosses the cube's edges. A quad surrounds every
// edge that the surface crosses. Everything beyond the grid counts as air, so the surface is closed: triangles pass
// each edge as often in one direction as in the other. If every share is 0 or 1, the shares are blurred once ([1 2 1] /
// 4 along each axis), since otherwise the surface would show the steps between voxels.
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"

namespace limber {

struct TriangleMesh {
  std::vector<glm::dvec3> V;  // #V positions, world, mm
  std::vector<glm::ivec3> F;  // #F triangles, counter-clockwise seen from outside
};

TriangleMesh surface_of(const Occupancy& body);

// Returns #V unit normals that point out of the body: the mean normal of the triangles around each vertex, weighted by
// area.
std::vector<glm::dvec3> vertex_normals(const TriangleMesh& mesh);

}  // namespace limber
