// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/organ_volumes.h"

#include <doctest/doctest.h>

#include "core/volume/connected_components.h"

using namespace limber;

namespace {

constexpr Label kMuscle = 1, kOrganLabel = 2, kBone = 3, kSkin = 4, kTiny = 5;

// A block of muscle in skin, with a ball of an organ and a bone beside it.
struct Block {
  LabelVolume posed;
  LabelSet soft = LabelSet(65536, 1), skin = LabelSet(65536, 0);

  explicit Block(double radius) {
    soft[kBone] = 0;
    skin[kSkin] = 1;
    posed.grid.size = glm::ivec3(40);
    posed.voxels.assign(posed.grid.voxel_count(), 0);
    for (int z = 4; z < 36; ++z)
      for (int y = 4; y < 36; ++y)
        for (int x = 4; x < 36; ++x) {
          const glm::ivec3 v(x, y, z);
          const bool is_outer = std::min({x, y, z}) == 4 || std::max({x, y, z}) == 35;
          const double away = glm::distance(glm::dvec3(v), glm::dvec3(18, 20, 20));
          posed.at(v) = is_outer ? kSkin : away < radius ? kOrganLabel : x > 24 && x < 28 ? kBone : kMuscle;
        }
  }
  std::int64_t count(Label label) const { return std::count(posed.voxels.begin(), posed.voxels.end(), label); }
};

}  // namespace

TEST_CASE("organ volumes: what is pressed small or drawn out comes within five percent, from its neighbours alone") {
  for (const double scale : {0.6, 1.5}) {
    Block block(6);
    const std::int64_t organ = block.count(kOrganLabel), muscle = block.count(kMuscle), bone = block.count(kBone),
                       skin = block.count(kSkin);
    const auto wanted = std::llround(double(organ) / scale);
    const auto parts = connected_components(block.posed).voxels.size();
    const auto given =
        keep_organ_volumes(block.posed, {{kOrganLabel, wanted}, {kMuscle, muscle}}, block.soft, block.skin);
    CHECK(std::abs(double(block.count(kOrganLabel)) / double(wanted) - 1) <= 0.05 + 1e-9);
    CHECK(given.at(kOrganLabel) == block.count(kOrganLabel) - organ);
    CHECK(block.count(kOrganLabel) + block.count(kMuscle) == organ + muscle);
    CHECK(block.count(kBone) == bone);
    CHECK(block.count(kSkin) == skin);
    CHECK(connected_components(block.posed).voxels.size() == parts);
  }
}

TEST_CASE("organ volumes: what is within its bounds stays as it is, and nobody gives more than he has over") {
  Block block(6);
  const LabelVolume before = block.posed;
  const std::int64_t organ = block.count(kOrganLabel), muscle = block.count(kMuscle);
  CHECK(keep_organ_volumes(block.posed, {{kOrganLabel, organ * 103 / 100}, {kMuscle, muscle}}, block.soft, block.skin)
            .empty());
  CHECK(block.posed.voxels == before.voxels);
  // Muscle has only 95 % of the volume that it should have, so it gives no voxels to the organ.
  keep_organ_volumes(block.posed, {{kOrganLabel, organ * 2}, {kMuscle, muscle * 100 / 95}}, block.soft, block.skin);
  CHECK(block.count(kMuscle) >= muscle - 1);
}

TEST_CASE("organ volumes: a crumb stays a crumb") {
  Block block(6);
  // These 8 voxels are not connected to the rest of the organ.
  for (int x = 8; x < 12; ++x)
    for (int y = 8; y < 10; ++y) block.posed.at({x, y, 8}) = kOrganLabel;
  const std::int64_t organ = block.count(kOrganLabel), muscle = block.count(kMuscle);
  keep_organ_volumes(block.posed, {{kOrganLabel, organ * 2}, {kMuscle, muscle}}, block.soft, block.skin);
  std::int64_t near = 0;
  for (int z = 5; z < 12; ++z)
    for (int y = 5; y < 13; ++y)
      for (int x = 5; x < 12; ++x)
        near +=
            glm::distance(glm::dvec3(x, y, z), glm::dvec3(9.5, 8.5, 8)) < 4 && block.posed.at({x, y, z}) == kOrganLabel;
  CHECK(near == 8);
  CHECK(block.count(kOrganLabel) > organ * 18 / 10);
}
