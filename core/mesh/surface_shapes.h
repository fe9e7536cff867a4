// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes surfaces of simple shapes, for obstacles. Each shape is centred at the origin, in mm, with triangles that are
// counter-clockwise seen from outside. The triangles are small enough for contact at their vertices: an edge is at most
// a tenth of the shape's largest extent and at most 20 mm long, unless this would need more than 200 000 triangles;
// then the edges are longer. Every function throws Error for an extent outside [0.001 mm, 1 km].
#pragma once

#include "core/mesh/surface.h"

namespace limber {

enum class CylinderEnds { Closed, Open };

// Triangles get no longer edges than this, mm, unless there would be too many triangles.
constexpr double kLongestShapeEdge = 20;
constexpr std::size_t kMostShapeTriangles = 200'000;

// Returns a closed box with these extents along x, y and z.
TriangleMesh box_surface(const glm::dvec3& size);

// Returns a cylinder along z whose vertices are on the exact cylinder. With open ends it is a tube without thickness,
// like a cuff; its outside faces away from the axis.
TriangleMesh cylinder_surface(double radius, double length, CylinderEnds ends = CylinderEnds::Closed);

// Returns a rectangle in the plane z = 0, with its outside towards +z.
//   width, depth  extents along x and y
TriangleMesh plane_surface(double width, double depth);

}  // namespace limber
