// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a body was cut off: volumes often hold only a part of one. The cut lies in the outermost layer of tissue along
// an axis of the grid, at the grid's border or behind a padding of air, and shows itself in one of two ways: there lie
// labels that the body's own surface hardly has (muscle, bone), or the cross-section is as large as it is a little
// deeper, where a sole or a crown would round off.
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"
#include "core/volume/label_volume.h"

namespace limber {

struct TissueCut {
  glm::dvec3 normal{0};  // world, unit, out of the tissue
  double offset = 0;     // mm: dot(normal, p) of the places on the cut
};

// At most one for each face of the tissue's box.
std::vector<TissueCut> tissue_cuts(const LabelVolume& volume);

// By how many mm a place lies beyond the cuts, the most of any; negative where none is passed, -infinity without cuts.
double beyond(const std::vector<TissueCut>& cuts, const glm::dvec3& place);

// Points that lie within `near` mm of a cut and face it are of the cut, not of the body.
void drop_cut_faces(std::vector<SurfacePoint>& points, const std::vector<TissueCut>& cuts, double near);

}  // namespace limber
