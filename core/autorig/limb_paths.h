// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the ends of a body and the paths to them. The ends (head, hands, feet) are the maxima of the distance through
// the tissue from its thickest point; the prominence of an end is how far one must go back from it before the way to a
// farther end branches off. Each path is the middle line of the tissue from an end inwards [Lazarus & Verroust 1999,
// level sets of the geodesic distance].
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"

namespace limber {

struct LimbPath {
  std::vector<glm::dvec3> points;  // world, from the end inwards, evenly spaced
  double step = 0;                 // distance between points, mm
  double prominence = 0;           // prominence of the end, mm
  double length = 0;               // length of the path through the tissue, mm

  // Returns the point `along` mm from the end, or the last point beyond the path.
  glm::dvec3 at(double along) const;
};

enum class PathCentre { Thickest, FarthestEnd };

// Returns a path from the end of each limb to the centre of the body, the end that stands out furthest first. `centre`
// selects which centre.
std::vector<LimbPath> limb_paths(const Occupancy& body, PathCentre centre);

}  // namespace limber
