// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of a body as triangles, where the share of tissue in a cell passes one half [Gibson, Constrained elastic
// surface nets, MICCAI 1998]: one vertex in every cube of eight cell centres that are not all inside, at the mean of
// the places where the cube's edges are crossed; a quad around every crossed edge. Beyond the grid is air, so the
// surface is closed: as many triangles pass each edge one way as the other. Shares that are all nothing or all are
// blurred once
// ([1 2 1] / 4 along each axis), or voxels would show as steps.
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"

namespace limber {

struct TriangleMesh {
  std::vector<glm::dvec3> V;  // #V places, world, mm
  std::vector<glm::ivec3> F;  // #F corners, counter-clockwise seen from outside
};

TriangleMesh surface_of(const Occupancy& body);

// #V unit normals out of the body, by the areas around each vertex.
std::vector<glm::dvec3> vertex_normals(const TriangleMesh& mesh);

}  // namespace limber
