// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/preserve_connectivity.h"

#include <algorithm>

#include <doctest/doctest.h>

#include "core/report/metrics.h"

using namespace limber;

namespace {

constexpr Label kFlesh = 1, kStrand = 2, kHard = 3;

const LabelSet& soft() {
  static const LabelSet set = [] {
    LabelSet all(65536, 1);
    all[kHard] = 0;
    return all;
  }();
  return set;
}

// A block of flesh in air with a square strand of 3 x 3 voxels along z.
LabelVolume block_with_strand() {
  LabelVolume volume;
  volume.grid.size = {13, 13, 24};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (int z = 1; z < 23; ++z)
    for (int y = 1; y < 12; ++y)
      for (int x = 1; x < 12; ++x)
        volume.at({x, y, z}) = std::abs(x - 6) <= 1 && std::abs(y - 6) <= 1 && z > 2 && z < 21 ? kStrand : kFlesh;
  return volume;
}

// Sets the slices `first` to `last` of the strand to `label`.
void cut(LabelVolume& volume, int first, int last, Label label) {
  for (int z = first; z <= last; ++z)
    for (int y = 5; y <= 7; ++y)
      for (int x = 5; x <= 7; ++x) volume.at({x, y, z}) = label;
}

std::int64_t mend_in_place(LabelVolume& posed, const LabelVolume& rest) {
  return preserve_connectivity(posed, rest, soft(), [](const glm::ivec3& v) { return glm::dvec3(v); });
}

int parts(const LabelVolume& volume, Label label) { return take_census(volume, kSmallestPart).components[label]; }

std::int64_t changes(const LabelVolume& a, const LabelVolume& b) {
  std::int64_t count = 0;
  for (size_t i = 0; i < a.voxels.size(); ++i) count += a.voxels[i] != b.voxels[i];
  return count;
}

}  // namespace

TEST_CASE("connectivity: a torn strand is rejoined by the fewest voxels, and nothing else changes") {
  const LabelVolume rest = block_with_strand();
  for (int gap = 1; gap <= 4; ++gap) {
    LabelVolume posed = rest;
    cut(posed, 11, 10 + gap, kFlesh);
    const LabelVolume torn = posed;
    REQUIRE(parts(torn, kStrand) == 2);
    CHECK(mend_in_place(posed, rest) == gap);
    CHECK(changes(posed, torn) == gap);
    CHECK(parts(posed, kStrand) == 1);
    CHECK(parts(posed, kFlesh) == 1);
  }
}

TEST_CASE("connectivity: what is whole stays as it is") {
  const LabelVolume rest = block_with_strand();
  LabelVolume posed = rest;
  CHECK(mend_in_place(posed, rest) == 0);
  CHECK(posed.voxels == rest.voxels);
}

TEST_CASE("connectivity: pieces that were apart at rest, or lie too far apart, stay apart") {
  LabelVolume rest = block_with_strand();
  LabelVolume posed = rest;
  cut(posed, 9, 13, kFlesh);
  const auto carried_apart = [](const glm::ivec3& v) {
    return glm::dvec3(v) + glm::dvec3(v.z >= 9 && v.z <= 13 ? 8 : 0, 0, 0);
  };
  CHECK(preserve_connectivity(posed, rest, soft(), carried_apart) == 0);

  // At rest there are two strands. The posed volume has one more piece, which comes from elsewhere.
  cut(rest, 11, 11, kFlesh);
  posed = rest;
  for (int z = 3; z < 10; ++z)
    for (int y = 9; y < 12; ++y)
      for (int x = 9; x < 12; ++x) posed.at({x, y, z}) = kStrand;
  const LabelVolume before = posed;
  const auto elsewhere = [](const glm::ivec3& v) { return glm::dvec3(v.x > 8 ? glm::ivec3(100) : v); };
  CHECK(preserve_connectivity(posed, rest, soft(), elsewhere) == 0);
  CHECK(posed.voxels == before.voxels);
}

TEST_CASE("connectivity: a strand that fell between the voxels' centres is traced along its way") {
  const LabelVolume rest = block_with_strand();
  LabelVolume posed = rest;
  cut(posed, 9, 14, kFlesh);
  // In the cut, each voxel's rest point lies two voxels beside the voxel, so the voxels of the strand read flesh.
  const auto beside = [](const glm::ivec3& v) {
    return glm::dvec3(v) + glm::dvec3(v.z >= 9 && v.z <= 14 ? 2 : 0, 0, 0);
  };
  CHECK(preserve_connectivity(posed, rest, soft(), beside) == 6);
  CHECK(parts(posed, kStrand) == 1);
}

TEST_CASE("connectivity: bridges take neither bone, nor what lies beside air, nor what would split another tissue") {
  const LabelVolume rest = block_with_strand();
  LabelVolume walled = rest;
  for (int y = 1; y < 12; ++y)
    for (int x = 1; x < 12; ++x) walled.at({x, y, 11}) = kHard;
  LabelVolume posed = walled;
  CHECK(mend_in_place(posed, rest) == 0);
  CHECK(posed.voxels == walled.voxels);

  // Now only the wall's outermost ring is flesh. A bridge through it would lie beside air, so none is made.
  for (int y = 1; y < 12; ++y)
    for (int x = 1; x < 12; ++x)
      if (x == 1 || x == 11 || y == 1 || y == 11) walled.at({x, y, 11}) = kFlesh;
  posed = walled;
  CHECK(mend_in_place(posed, rest) == 0);

  // Now the wall has a hole, but a thin thread of another tissue fills it. A bridge through the hole would split the
  // thread, so none is made.
  constexpr Label kThread = 4;
  for (int z = 8; z < 15; ++z) walled.at({6, 6, z}) = kThread;
  posed = walled;
  CHECK(mend_in_place(posed, rest) == 0);
  CHECK(posed.voxels == walled.voxels);
}

TEST_CASE(
    "connectivity: a bone that comes apart is rejoined through soft tissue, one that was two pieces at rest is not") {
  LabelVolume tissue = block_with_strand();
  cut(tissue, 3, 20, kHard);
  LabelVolume rest = tissue;
  for (Label& label : rest.voxels) label = label == kHard ? 9 : 0;
  LabelVolume posed = rest;
  cut(tissue, 11, 12, kFlesh);
  cut(posed, 11, 12, 0);
  const auto same_place = [](const glm::ivec3& v) { return glm::dvec3(v); };

  LabelVolume apart = rest, still = posed;
  cut(apart, 11, 11, 0);
  CHECK(mend_bones(still, apart, tissue, soft(), same_place).empty());
  CHECK(still.voxels == posed.voxels);

  const auto bridge = mend_bones(posed, rest, tissue, soft(), same_place);
  REQUIRE(bridge.size() == 2);
  for (const glm::ivec3& voxel : bridge) {
    CHECK(posed.at(voxel) == 9);
    CHECK(tissue.at(voxel) == kFlesh);
  }
  CHECK(parts(posed, 9) == 1);
}

namespace {

// Two pieces of marrow in one block of hard bone, with a wall of one voxel between them and flesh around.
constexpr Label kShell = 3, kMarrow = 5;

LabelVolume bone_with_two_marrows() {
  LabelVolume volume;
  volume.grid.size = {15, 15, 20};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (int z = 1; z < 19; ++z)
    for (int y = 1; y < 14; ++y)
      for (int x = 1; x < 14; ++x) {
        const bool bone = x > 2 && x < 12 && y > 2 && y < 12 && z > 2 && z < 17;
        const bool marrow = x > 4 && x < 10 && y > 4 && y < 10 && z > 4 && z < 15 && z != 10;
        volume.at({x, y, z}) = marrow ? kMarrow : bone ? kShell : kFlesh;
      }
  return volume;
}

const LabelSet& not_bone() {
  static const LabelSet set = [] {
    LabelSet all(65536, 1);
    all[kShell] = all[kMarrow] = 0;
    return all;
  }();
  return set;
}

std::int64_t mend_bone_tissue(LabelVolume& posed, const LabelVolume& rest) {
  return preserve_connectivity(posed, rest, not_bone(), [](const glm::ivec3& v) { return glm::dvec3(v); });
}

}  // namespace

TEST_CASE("connectivity: a hole in the wall between two marrows is closed, the whole wall's loss too") {
  const LabelVolume rest = bone_with_two_marrows();
  for (int width : {1, 3, 5}) {
    LabelVolume posed = rest;
    for (int y = 5; y < 5 + width; ++y)
      for (int x = 5; x < 5 + width; ++x) posed.at({x, y, 10}) = kMarrow;
    const LabelVolume fused = posed;
    REQUIRE(parts(fused, kMarrow) == 1);
    CHECK(mend_bone_tissue(posed, rest) > 0);
    CHECK(parts(posed, kMarrow) == 2);
    CHECK(parts(posed, kShell) == 1);
    CHECK(changes(posed, fused) <= 2 * (width + 1) * (width + 1));
    for (size_t i = 0; i < posed.voxels.size(); ++i) CHECK((fused.voxels[i] == kFlesh) == (posed.voxels[i] == kFlesh));
  }
}

TEST_CASE(
    "connectivity: bone tissue that came out a few voxels too small is filled up, one that lost most of itself is "
    "not") {
  LabelVolume rest = bone_with_two_marrows();
  for (int z = 13; z < 15; ++z)
    for (int y = 5; y < 10; ++y)
      for (int x = 5; x < 10; ++x) rest.at({x, y, z}) = kShell;
  REQUIRE(parts(rest, kMarrow) == 2);  // pieces of 125 and 50 voxels
  for (const int rows : {1, 4}) {
    LabelVolume posed = rest;
    for (int y = 5; y < 5 + rows; ++y)
      for (int x = 5; x < 10; ++x)
        for (int z = 11; z < 13; ++z) posed.at({x, y, z}) = kShell;
    REQUIRE(parts(posed, kMarrow) == 1);
    const bool filled = rows == 1;
    CHECK(mend_bone_tissue(posed, rest) == (filled ? 10 : 0));
    CHECK(parts(posed, kMarrow) == (filled ? 2 : 1));
  }
}

TEST_CASE("connectivity: bone tissue that the grid made large enough to count gives back what it gained") {
  LabelVolume rest = bone_with_two_marrows();
  for (int z = 13; z < 15; ++z)
    for (int y = 5; y < 10; ++y)
      for (int x = 5; x < 10; ++x) rest.at({x, y, z}) = kShell;
  for (int x = 5; x < 8; ++x) rest.at({x, 5, 12}) = kShell;
  REQUIRE(parts(rest, kMarrow) == 1);  // a piece of 125 voxels; the other, of 47, is too small to count
  LabelVolume posed = rest;
  for (int x = 5; x < 10; ++x) posed.at({x, 5, 12}) = kMarrow;
  REQUIRE(parts(posed, kMarrow) == 2);
  CHECK(mend_bone_tissue(posed, rest) == 1);
  CHECK(parts(posed, kMarrow) == 1);
  CHECK(parts(posed, kShell) == 1);
}

TEST_CASE("connectivity: a small bone that lost a few voxels takes them back from soft tissue") {
  LabelVolume tissue = block_with_strand();
  LabelVolume rest = tissue;
  for (Label& label : rest.voxels) label = 0;
  cut(tissue, 8, 13, kHard);
  cut(rest, 8, 13, 9);  // a small bone of 54 voxels
  LabelVolume posed = rest;
  cut(tissue, 13, 13, kFlesh);
  cut(posed, 13, 13, 0);
  const auto taken = mend_bones(posed, rest, tissue, soft(), [](const glm::ivec3& v) { return glm::dvec3(v); });
  CHECK(taken.size() == 5);
  CHECK(parts(posed, 9) == 1);
  for (const glm::ivec3& voxel : taken) CHECK(tissue.at(voxel) != kHard);
}
