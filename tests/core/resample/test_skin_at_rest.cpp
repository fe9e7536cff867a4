// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/skin_at_rest.h"

#include <doctest/doctest.h>

#include "core/resample/posed_skin.h"

using namespace limber;

namespace {

constexpr Label kSkin = 1, kFlesh = 2, kBone = 3;

LabelSet set_of(std::initializer_list<Label> labels) {
  LabelSet set(65536, 0);
  for (const Label label : labels) set[label] = 1;
  return set;
}

// A bar of bone in flesh, in slices of 6 mm. Each slice has skin on three sides. On the fourth side flesh is bare, with
// one voxel of bone at the surface.
LabelVolume open_body() {
  LabelVolume volume;
  volume.grid.size = {24, 24, 10};
  volume.grid.spacing = {2, 2, 6};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count());
  for (int z = 1; z < 9; ++z)
    for (int y = 2; y < 22; ++y)
      for (int x = 2; x < 22; ++x) {
        const bool is_skin = x == 2 || y == 2 || y == 21,
                   is_bone = std::abs(x - 12) < 3 && std::abs(y - 12) < 3 && z > 1 && z < 8;
        volume.at({x, y, z}) = is_bone ? kBone : is_skin ? kSkin : kFlesh;
      }
  volume.at({21, 12, 4}) = kBone;
  return volume;
}

}  // namespace

TEST_CASE("skin at rest: of a body with open skin bone that lay deep inside was covered, bare bone was not") {
  const LabelVolume volume = open_body();
  const TissueVoxels tissue(volume);
  const TissueDepth depth(tissue, volume.grid.spacing);
  const LabelSet soft = set_of({kSkin, kFlesh}), skin = set_of({kSkin});
  const SkinAtRest rest(volume, tissue, depth, soft, skin);
  CHECK(rest.was_bone_covered({12, 12, 4}));
  CHECK_FALSE(rest.was_bone_covered({21, 12, 4}));
  CHECK_FALSE(rest.was_covered({21, 8, 4}));
  CHECK(rest.was_covered({12, 6, 4}));
}

TEST_CASE("posed skin: bone that came to the air gets skin over it where skin is near, walls of enclosed air stay") {
  LabelVolume posed = open_body();
  const LabelSet flesh = set_of({kFlesh}), bone = set_of({kBone}), skin = set_of({kSkin});
  posed.at({2, 10, 4}) = kBone;  // bone that breaks through the skin
  posed.at({12, 17, 4}) = 0;     // air that the body encloses
  std::vector<UnderSkin> under{{posed.grid.index({2, 10, 4}), 0}, {posed.grid.index({12, 18, 4}), 0}};
  std::vector<glm::ivec3> was_air;
  CHECK(cover_bare_flesh(posed, air_pockets(posed), under, flesh, bone, skin, was_air) == 1);
  REQUIRE(was_air.size() == 1);
  CHECK(was_air[0] == glm::ivec3(1, 10, 4));
  CHECK(posed.at({1, 10, 4}) == kSkin);
  CHECK(posed.at({2, 10, 4}) == kBone);
  CHECK(posed.at({12, 18, 4}) == kFlesh);
}
