// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/limb_thickness.h"

#include <algorithm>

namespace limber {

namespace {

// If a move to a deeper point multiplies the depth by at least this number, it was a move towards the limb's axis.
constexpr double kTowardsMiddle = 1.75;

struct DeepVoxel {
  glm::ivec3 voxel{0};
  double depth = 0;  // distance to the nearest air, mm
};

// Returns the deepest voxel (furthest from air) whose centre is within `radius` mm of a point. If several voxels are
// equally deep, returns the first of them in the order of the volume.
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
  // Moves to the deepest point of the ball around the current point that just touches air. If the current point is off
  // the limb's axis, the new one is about twice as deep. If it is on the axis, the new one is hardly deeper, and
  // further moves would go along the limb to where the limb is thicker.
  for (double before = 0; deepest.depth > kTowardsMiddle * before;) {
    before = deepest.depth;
    deepest = deepest_within(depth, grid, glm::dvec3(deepest.voxel), deepest.depth);
  }
  return 2 * deepest.depth;
}

}  // namespace limber
