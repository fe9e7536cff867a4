// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/place_in_tissue.h"

#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

#include "core/autorig/place_rig.h"

namespace limber::test {

namespace {

// Makes a trunk of 20 x 20 mm from z = 0 to 100 on two legs of 16 x 16 mm down to z = -100, in voxels of 2 mm.
LabelVolume small_figure() {
  LabelVolume volume;
  volume.grid.size = {50, 20, 110};
  volume.grid.spacing = {2, 2, 2};
  volume.grid.origin = {-49, -19, -109};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  const AffineTransform world = world_from_voxel(volume.grid);
  for (int z = 0; z < 110; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 50; ++x) {
        const glm::dvec3 p = world * glm::dvec3(x, y, z);
        const bool trunk = std::abs(p.x) < 10 && std::abs(p.y) < 10 && p.z > -10 && p.z < 100;
        const bool leg = std::abs(std::abs(p.x) - 30) < 8 && std::abs(p.y) < 8 && p.z > -100 && p.z < 0;
        const bool hip = std::abs(p.x) < 38 && std::abs(p.y) < 8 && std::abs(p.z) < 8;
        volume.at({x, y, z}) = trunk || leg || hip;
      }
  return volume;
}

// Makes the figure's skeleton, with names that do not tell which part of the body a bone is.
Armature figure_rig() {
  Armature rig;
  rig.bones = {{.name = "p", .parent = -1, .head = {0, 0, 0}, .tail = {0, 0, 96}},
               {.name = "q", .parent = 0, .head = {0, 0, 0}, .tail = {-30, 0, 0}},
               {.name = "r", .parent = 1, .head = {-30, 0, 0}, .tail = {-30, 0, -96}},
               {.name = "s", .parent = 0, .head = {0, 0, 0}, .tail = {30, 0, 0}},
               {.name = "t", .parent = 3, .head = {30, 0, 0}, .tail = {30, 0, -96}}};
  return rig;
}

}  // namespace

TEST_CASE("placing: a rig in other units, lying or on its head, is set upright into the tissue") {
  const LabelVolume volume = small_figure();
  for (const double scale : {1.0, 0.001, 25.4})
    for (const auto& [axis, degrees] : {std::pair(glm::dvec3(1, 0, 0), 0.0),
                                        {{1, 0, 0}, 180.0},
                                        {{1, 0, 0}, 90.0},
                                        {{0, 1, 0}, -90.0},
                                        {{0, 0, 1}, 90.0}}) {
      CAPTURE(scale);
      CAPTURE(degrees);
      const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(glm::radians(degrees), axis));
      const Armature placed =
          placed_in_tissue(volume, moved_rig(figure_rig(), turn, scale, glm::dvec3(0), glm::dvec3(700, 20, 3)));
      CHECK(check_rig(volume, placed).whole > 0.95);
      CHECK(placed.bones[0].tail.z > 90);
    }
}

TEST_CASE("placing: where a fit finds no joint with confidence the rig is placed, and it is said") {
  const LabelVolume volume = small_figure();
  const Armature rig = moved_rig(figure_rig(), glm::mat3_cast(glm::angleAxis(glm::radians(180.0), glm::dvec3(1, 0, 0))),
                                 1, glm::dvec3(0), glm::dvec3(0));
  const AutoFit fitted = fitted_or_placed(volume, {}, rig);
  CHECK(fitted.check.whole > 0.95);
  CHECK(fitted.armature.bones[0].tail.z > 90);
  REQUIRE(fitted.warnings.size() == 1);
  CHECK(fitted.warnings[0].starts_with("no joint could be found with confidence"));
}

}  // namespace limber::test
