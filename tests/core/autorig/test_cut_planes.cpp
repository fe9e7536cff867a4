// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/cut_planes.h"

#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

namespace limber {

namespace {

// Makes a ball of 60 mm radius in voxels of 2 mm, cut off `top` mm above its middle, with `padding` layers of air above
// the cut. If layered, its outermost 4 mm have label 1 (skin) and the inside has label 2; else all of it has label 1.
LabelVolume cut_ball(double top, int padding, bool is_layered) {
  LabelVolume volume{{{70, 70, 0}, {2, 2, 2}, {10, 20, 30}, glm::mat3_cast(glm::angleAxis(0.7, glm::dvec3(0, 1, 0)))},
                     {}};
  volume.grid.size.z = static_cast<int>(std::floor((top + 70) / 2)) + 1 + padding;
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 70; ++x) {
        const glm::dvec3 p = 2.0 * glm::dvec3(x, y, z) - 70.0;
        const double r = glm::length(p);
        volume.voxels.push_back(r > 60 || p.z > top ? 0 : is_layered && r < 56 ? 2 : 1);
      }
  return volume;
}

}  // namespace

TEST_CASE(
    "tissue cuts: a ball has none, half a ball one, at the border and behind air, by its labels or its straight "
    "walls") {
  CHECK(tissue_cuts(cut_ball(70, 0, false)).empty());
  CHECK(tissue_cuts(cut_ball(70, 2, true)).empty());
  for (int padding : {0, 4})
    for (const auto& [top, is_layered] : {std::pair(0.0, false), std::pair(0.0, true), std::pair(40.0, true)}) {
      CAPTURE(padding);
      CAPTURE(top);
      const LabelVolume volume = cut_ball(top, padding, is_layered);
      const auto cuts = tissue_cuts(volume);
      REQUIRE(cuts.size() == 1);
      const AffineTransform to_world = world_from_voxel(volume.grid);
      const glm::dvec3 on_cut = to_world * glm::dvec3(35, 35, (top + 70) / 2 + 0.5),
                       above = to_world * glm::dvec3(35, 35, (top + 70) / 2 + 5.5);
      CHECK(std::abs(beyond(cuts, on_cut)) < 1e-9);
      CHECK(beyond(cuts, above) == doctest::Approx(10));
    }
  CHECK(beyond({}, glm::dvec3(1, 2, 3)) < 0);
}

TEST_CASE("tissue cuts: the face of a cut is no surface, what lies beside it is") {
  const std::vector<TissueCut> cuts{{{0, 0, 1}, 100}};
  std::vector<SurfacePoint> points{{{0, 0, 99}, {0, 0, 1}}, {{0, 0, 99}, {1, 0, 0}}, {{0, 0, 90}, {0, 0, 1}}};
  drop_cut_faces(points, cuts, 5);
  CHECK(points.size() == 2);
}

}  // namespace limber
