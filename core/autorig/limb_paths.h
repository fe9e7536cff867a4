// SPDX-License-Identifier: AGPL-3.0-or-later
// The ends of a body and the ways to them: where the distance through the tissue from its thickest place has summits
// (head, hands, feet; the prominence of a summit is how far one must go back from it before another is nearer), and the
// middle line of the tissue from each summit inwards [Lazarus & Verroust 1999, level sets of the geodesic distance].
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"

namespace limber {

struct LimbPath {
  std::vector<glm::dvec3> points;  // world, from the end inwards, evenly spaced
  double step = 0;                 // mm between points
  double prominence = 0;           // mm
  double length = 0;               // mm, through the tissue

  // The point `along` mm from the end; the last one beyond.
  glm::dvec3 at(double along) const;
};

enum class PathCentre { Thickest, FarthestEnd };

// Most prominent first.
std::vector<LimbPath> limb_paths(const Occupancy& body, PathCentre centre);

}  // namespace limber
