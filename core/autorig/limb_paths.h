// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the ends of a body and the paths to them. The ends (head, hands, feet) are the local maxima of the distance
// through the tissue from its thickest point. The prominence of an end is the distance from the end back to the point
// where the path to a farther end branches off. Each path is the middle line of the tissue from an end inwards [Lazarus
// & Verroust 1999, level sets of the geodesic distance].
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"

namespace limber {

struct LimbPath {
  std::vector<glm::dvec3> points;  // evenly spaced points from the end of the limb inwards, world, mm
  double step = 0;                 // distance between successive points, mm
  double prominence = 0;           // prominence of the path's end, mm
  double length = 0;               // length of the path through the tissue, mm

  // Returns the point of the path that is `along` mm from the end of the limb. Beyond the path, returns its last point.
  glm::dvec3 at(double along) const;
};

enum class PathCentre { Thickest, FarthestEnd };

// Returns a path from each end of the body to its centre, the most prominent end first. `centre` selects the centre:
// the thickest point of the tissue, or the end that is farthest away.
std::vector<LimbPath> limb_paths(const Occupancy& body, PathCentre centre);

}  // namespace limber
