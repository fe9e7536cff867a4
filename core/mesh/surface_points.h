// SPDX-License-Identifier: AGPL-3.0-or-later
// Samples the surface of selected tissue in a label volume as points with outward normals, and finds the nearest of
// such points. The volume is first reduced to cells of about equal size, each with the share that the tissue fills.
// Points are between cell centres where this share is one half, so that they do not depend on the voxels' shape. There
// is no surface where the border of the grid cuts tissue off.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"

namespace limber {

// The cells of a reduced grid, each with the share of its volume that tissue fills, in [0, 1].
struct Occupancy {
  Grid grid;
  std::vector<float> share;

  bool filled(const glm::ivec3& cell) const { return grid.contains(cell) && share[grid.index(cell)] >= 0.5f; }
};

// Reduces a volume to larger cells, each with the share of its volume that tissue fills.
//   labels   one byte per label: not 0 if the label counts as tissue
//   spacing  size of a cell along each axis, mm; rounded to a whole number of voxels, at least one
Occupancy occupancy_of(const LabelVolume& volume, const LabelSet& labels, double spacing);

// Fills air that tissue encloses, and removes specks: connected components of tissue with less than 1/50 of the cells
// of the largest component.
void close_body(Occupancy& body);

// Returns the same body in larger cells of about `spacing` mm, each a whole number of cells of `fine`. The part of the
// last cells that extends beyond the grid of `fine` counts as empty.
Occupancy coarsened(const Occupancy& fine, double spacing);

struct SurfacePoint {
  glm::dvec3 place{0}, normal{0};  // position, world, mm; unit normal, pointing out of the tissue
};

std::vector<SurfacePoint> surface_points(const Occupancy& occupancy);

// Keeps the first point in each cube of a grid with cubes of `step` mm, and returns these points.
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double step);

// Finds nearest points by a k-d tree. Of several points at the same distance, the one with the smallest index is
// returned.
class PointTree {
 public:
  explicit PointTree(const std::vector<SurfacePoint>& points);
  // Returns the index of the nearest point that is closer than `reach` mm and whose normal is within 60 degrees of
  // `normal` (any normal if `normal` is zero); -1: there is no such point.
  int nearest(const glm::dvec3& place, const glm::dvec3& normal, double reach) const;

 private:
  struct Node {
    SurfacePoint point;
    std::int32_t number = 0;  // index into the points given to the constructor
  };
  struct Search {
    glm::dvec3 place, normal;
    double least_facing, squared;
    int best = -1;
  };
  void build(int begin, int end);
  void look_in(int begin, int end, Search& search) const;
  std::vector<Node> nodes_;  // each range of nodes is split at its middle node, along the axis in `axis_`
  std::vector<std::uint8_t> axis_;
};

}  // namespace limber
