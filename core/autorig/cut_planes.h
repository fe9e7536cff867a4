// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the planes at which a body is cut off, since volumes often contain only a part of a body. A cut is in the
// outermost layer of tissue along an axis of the grid, at the grid's border or behind a padding of air. It is
// recognised in two ways: the layer has labels that are rare on the rest of the surface (muscle, bone), or its area is
// as large as that of a parallel section a few mm deeper in the body, while a sole or a crown is rounded.
#pragma once

#include <vector>

#include "core/mesh/surface_points.h"
#include "core/volume/label_volume.h"

namespace limber {

struct TissueCut {
  glm::dvec3 normal{0};  // unit normal of the cut, pointing out of the tissue, world
  double offset = 0;     // dot(normal, p) for every point p on the cut, mm
};

// Returns the planes at which the body is cut off, at most one for each face of the tissue's bounding box.
std::vector<TissueCut> tissue_cuts(const LabelVolume& volume);

// Returns how far a point is beyond the planes at which the body is cut off, mm: the largest signed distance from any
// of the planes. Negative if the point is on the body's side of all planes, -infinity without planes.
double beyond(const std::vector<TissueCut>& cuts, const glm::dvec3& place);

// Removes the surface points that are within `near` mm of a cut and whose normals point out of it, since they belong to
// the cut and not to the body's own surface.
void drop_cut_faces(std::vector<SurfacePoint>& points, const std::vector<TissueCut>& cuts, double near);

}  // namespace limber
