// SPDX-License-Identifier: AGPL-3.0-or-later
// The surface of some tissue of a label volume as points with outward normals, and the nearest of such points. The
// volume is first reduced to cells of about one size that know which share of them the tissue fills, so points lie
// between voxel centres where that share passes one half, whatever the voxels' shape. Where tissue is cut off by the
// border of the grid there is no surface.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"

namespace limber {

// Cells of a reduced grid with the share of each that is filled, 0 .. 1.
struct Occupancy {
  Grid grid;
  std::vector<float> share;

  bool filled(const glm::ivec3& cell) const { return grid.contains(cell) && share[grid.index(cell)] >= 0.5f; }
};

//   labels   a byte per label, not 0 for those that count
//   spacing  mm that a cell should measure along each axis at least; cells are whole numbers of voxels
Occupancy occupancy_of(const LabelVolume& volume, const LabelSet& labels, double spacing);

// Air that no way leads to from outside counts as filled; specks apart from the largest connected piece do not.
void close_body(Occupancy& body);

// The same in cells of about `spacing` mm, whole numbers of its own; what the last ones lack is taken for empty.
Occupancy coarsened(const Occupancy& fine, double spacing);

struct SurfacePoint {
  glm::dvec3 place{0}, normal{0};  // world, mm; unit, out of the tissue
};

std::vector<SurfacePoint> surface_points(const Occupancy& occupancy);

// One point per cube of `step` mm, the first of each.
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double step);

// Nearest points in a k-d tree; ties go to the smaller number.
class PointTree {
 public:
  explicit PointTree(const std::vector<SurfacePoint>& points);
  // The nearest point no farther than `reach` whose normal lies within 60 degrees of `normal` (any, for zero); -1 for
  // none.
  int nearest(const glm::dvec3& place, const glm::dvec3& normal, double reach) const;

 private:
  struct Node {
    SurfacePoint point;
    std::int32_t number = 0;  // among those given
  };
  struct Search {
    glm::dvec3 place, normal;
    double least_facing, squared;
    int best = -1;
  };
  void build(int begin, int end);
  void look_in(int begin, int end, Search& search) const;
  std::vector<Node> nodes_;  // a range's middle parts it across `axis_`
  std::vector<std::uint8_t> axis_;
};

}  // namespace limber
