// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/depth.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

using namespace limber;

namespace {

// A ball with holes, off the middle of the grid.
LabelVolume ball_with_holes() {
  LabelVolume volume{{.size = {29, 26, 31}}, ZeroedVector<Label>(29 * 26 * 31)};
  std::mt19937 random(3);
  for (int z = 0; z < 31; ++z)
    for (int y = 0; y < 26; ++y)
      for (int x = 0; x < 29; ++x)
        volume.at({x, y, z}) = glm::distance(glm::dvec3(x, y, z), glm::dvec3(13, 11, 16)) < 13 && random() % 300 != 0;
  return volume;
}

// Returns the squared distance in mm^2 from a voxel to the nearest voxel of air; outside the grid is air.
double squared_depth(const LabelVolume& volume, const glm::ivec3& voxel, const glm::dvec3& spacing) {
  if (volume.at(voxel) == 0) return 0;
  double least = INFINITY;
  for (int z = -1; z <= volume.grid.size.z; ++z)
    for (int y = -1; y <= volume.grid.size.y; ++y)
      for (int x = -1; x <= volume.grid.size.x; ++x) {
        if (volume.at_or_air({x, y, z})) continue;
        const glm::dvec3 way = glm::dvec3(glm::ivec3(x, y, z) - voxel) * spacing;
        least = std::min(least, glm::dot(way, way));
      }
  return least;
}

}  // namespace

TEST_CASE("depth: it is the distance to the nearest air, with voxels of any shape, exactly where floats hold it") {
  const LabelVolume volume = ball_with_holes();
  const TissueVoxels tissue(volume);
  for (const glm::dvec3& spacing : {glm::dvec3(0.5), glm::dvec3(0.7), glm::dvec3(1, 2, 3), glm::dvec3(1.0 / 3)}) {
    const TissueDepth depth(tissue, spacing);
    double worst = 0;
    for (int z = 0; z < volume.grid.size.z; z += 3)
      for (int y = 0; y < volume.grid.size.y; y += 2)
        for (int x = 0; x < volume.grid.size.x; x += 2) {
          const double wanted = std::sqrt(squared_depth(volume, {x, y, z}, spacing));
          worst = std::max(worst, std::abs(depth.at_voxel({x, y, z}) - wanted) / std::max(wanted, 1e-9));
        }
    CHECK(worst < 1e-6);
  }
  // If the limit is 20, the squared depths of this body exceed it, so they are stored as floats. The depths must equal
  // those that are stored as whole numbers.
  const TissueDepth as_steps(tissue, glm::dvec3(0.7)), as_floats(tissue, glm::dvec3(0.7), 20);
  double furthest = 0;
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    CHECK(as_steps.at_voxel(v) == doctest::Approx(as_floats.at_voxel(v)).epsilon(1e-6));
    furthest = std::max(furthest, double{as_steps.at_voxel(v)});
  });
  CHECK(furthest > 0.7 * std::sqrt(20.0) + 1);
  // With voxels of 0.5 mm, squared depths are multiples of 0.25 mm2. Floats hold them exactly, so the depths must be
  // equal bit for bit.
  const TissueDepth depth(tissue, glm::dvec3(0.5));
  for (const glm::ivec3 v : {glm::ivec3(13, 11, 16), glm::ivec3(9, 14, 20), glm::ivec3(2, 11, 15)})
    CHECK(depth.at_voxel(v) == std::sqrt(static_cast<float>(squared_depth(volume, v, glm::dvec3(0.5)))));
}

TEST_CASE("depth: between voxels it is interpolated, in one brick and across its border alike") {
  const LabelVolume volume = ball_with_holes();
  const TissueVoxels tissue(volume);
  const TissueDepth depth(tissue, glm::dvec3(0.5));
  for (const glm::ivec3 low : {glm::ivec3(10, 10, 18), glm::ivec3(15, 7, 15)}) {
    double mean = 0;
    for (int k = 0; k < 8; ++k) mean += depth.at_voxel(low + glm::ivec3(k & 1, k >> 1 & 1, k >> 2)) / 8;
    CHECK(depth(glm::dvec3(low) + 0.5) == doctest::Approx(mean).epsilon(1e-6));
  }
}
