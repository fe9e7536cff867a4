// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/rig_check.h"

#include <doctest/doctest.h>

namespace limber {

TEST_CASE("fit check: a bone half in tissue is half in, and the place where it leaves is told") {
  LabelVolume volume{{{20, 5, 5}, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, {}};
  volume.voxels.assign(volume.grid.voxel_count(), 1);
  Armature rig;
  rig.bones = {{.name = "In", .parent = -1, .head = {2, 2, 2}, .tail = {9, 2, 2}},
               {.name = "Out", .parent = 0, .head = {9.5, 2, 2}, .tail = {29.5, 2, 2}}};
  const RigCheck check = check_rig(volume, rig);
  CHECK(check.share[0] == 1);
  CHECK(check.share[1] == doctest::Approx(0.5).epsilon(0.05));
  CHECK(check.whole == doctest::Approx((7 + 10) / 27.0).epsilon(0.05));
  REQUIRE(check.leaving.size() == 1);
  CHECK(check.leaving[0].bone == 1);
  CHECK(glm::distance(check.leaving[0].place, glm::dvec3(24.5, 2, 2)) < 0.5);
  REQUIRE(check.outside.size() == 1);
  CHECK(check.outside[0].tail);
  CHECK(check.outside[0].place == rig.bones[1].tail);
}

TEST_CASE("fit check: where bones meet outside, the joint is told once, as a tail") {
  LabelVolume volume{{{5, 5, 5}, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, ZeroedVector<Label>(125, 1)};
  Armature rig;
  rig.bones = {{.name = "A", .parent = -1, .head = {2, 2, 2}, .tail = {9, 2, 2}},
               {.name = "B", .parent = 0, .head = {9, 2, 2}, .tail = {2, 2, 4}},
               {.name = "C", .parent = 0, .head = {9, 2, 2}, .tail = {2, 4, 2}}};
  const RigCheck check = check_rig(volume, rig);
  REQUIRE(check.outside.size() == 1);
  CHECK(check.outside[0].bone == 0);
  CHECK(check.outside[0].tail);
  CHECK(check.leaving.size() == 3);
}

TEST_CASE("fit check: a rig far outside the grid is outside, whatever the numbers") {
  LabelVolume volume{{{2, 2, 2}, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, ZeroedVector<Label>(8, 1)};
  Armature rig;
  rig.bones = {{.name = "Far", .parent = -1, .head = {1e30, 0, 0}, .tail = {-1e30, 1e30, 5}}};
  CHECK(check_rig(volume, rig).whole == 0);
}

}  // namespace limber
