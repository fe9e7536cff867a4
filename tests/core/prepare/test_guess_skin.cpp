// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/guess_skin.h"

#include <doctest/doctest.h>

using namespace limber;

namespace {

constexpr Label kSheet = 1, kFlesh = 2;

// Makes a ball of flesh with a hollow in its middle. Its outermost layer, `sheet` voxels thick, has the label kSheet.
LabelVolume ball(double sheet) {
  LabelVolume volume;
  volume.grid.size = {40, 40, 40};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  for (int z = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const double r = glm::length(glm::dvec3(x, y, z) - 19.5);
        volume.at({x, y, z}) = r > 18 || r < 4 ? 0 : r > 18 - sheet ? kSheet : kFlesh;
      }
  return volume;
}

TissueTable table(TissueKind sheet, TissueKind flesh) {
  TissueTable table;
  table.tissues = {{.label = kSheet, .file_value = 1, .kind = sheet},
                   {.label = kFlesh, .file_value = 2, .kind = flesh}};
  return table;
}

}  // namespace

TEST_CASE("guess skin: a thin sheet all over the body is skin, whatever is bare inside it") {
  const auto guess = guess_skin(ball(2), table(TissueKind::Unknown, TissueKind::Unknown));
  REQUIRE(guess);
  CHECK(guess->label == kSheet);
  CHECK(guess->share_of_surface == 1);
  const TissueTable known = with_skin(table(TissueKind::Unknown, TissueKind::Bone), kSheet);
  CHECK(known.find(kSheet)->kind == TissueKind::Skin);
  CHECK(known.find(kFlesh)->kind == TissueKind::Bone);
  CHECK(known.find(kSheet)->colour == glm::vec3(0.7f));
}

TEST_CASE("guess skin: what is thick, open, known, or beside known skin is not") {
  const TissueTable unknown = table(TissueKind::Unknown, TissueKind::Unknown);
  CHECK_FALSE(guess_skin(ball(8), unknown));
  LabelVolume open = ball(2);
  for (int z = 25; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x)
        if (open.at({x, y, z}) == kSheet) open.at({x, y, z}) = kFlesh;
  CHECK_FALSE(guess_skin(open, unknown));
  CHECK_FALSE(guess_skin(ball(2), table(TissueKind::Fat, TissueKind::Unknown)));
  CHECK_FALSE(guess_skin(ball(2), table(TissueKind::Unknown, TissueKind::Skin)));
}
