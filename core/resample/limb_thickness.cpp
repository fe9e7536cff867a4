// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/limb_thickness.h"

#include <algorithm>

namespace limber {

namespace {

constexpr double kTowardsMiddle = 1.75;  // smallest ratio of depths that means a move towards the limb's axis

struct DeepVoxel {
  glm::ivec3 voxel{0};
  double depth = 0;  // mm
};

// Returns the deepest voxel whose centre is within `radius` mm of a point; of equally deep ones the first in x, y, z.
DeepVoxel deepest_within(const TissueDepth& depth, const Grid& grid, const glm::dvec3& centre, double radius) {
  const glm::dvec3 reach = radius / grid.spacing;
  const glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(centre - reach)), glm::ivec3(0)),
                   high = glm::min(glm::ivec3(glm::floor(centre + reach)), grid.size - 1);
  DeepVoxel deepest;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const glm::ivec3 voxel(x, y, z);
        const double here = depth.at_voxel(voxel);
        if (here > deepest.depth && glm::length((glm::dvec3(voxel) - centre) * grid.spacing) <= radius)
          deepest = {voxel, here};
      }
  return deepest;
}

}  // namespace

std::optional<double> limb_thickness(const TissueDepth& depth, const Grid& grid, const glm::dvec3& joint) {
  const glm::dvec3 place = voxel_from_world(grid) * joint, extent = glm::dvec3(grid.size) * grid.spacing;
  const double voxel = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z}),
               furthest = std::max({extent.x, extent.y, extent.z}) / 4;
  DeepVoxel deepest = deepest_within(depth, grid, place, voxel);
  for (double radius = 2 * voxel; deepest.depth == 0; radius *= 2) {
    if (radius > furthest) return std::nullopt;
    deepest = deepest_within(depth, grid, place, radius);
  }
  // Off the limb's axis the deepest point of the ball is twice as deep as its centre. On the axis it is hardly deeper,
  // and further balls would move along the limb to where it is thicker.
  for (double before = 0; deepest.depth > kTowardsMiddle * before;) {
    before = deepest.depth;
    deepest = deepest_within(depth, grid, glm::dvec3(deepest.voxel), deepest.depth);
  }
  return 2 * deepest.depth;
}

}  // namespace limber
