// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/metrics.h"

#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"

using namespace limber;

namespace {
LabelVolume random_volume(const glm::ivec3& size, int labels, double air, unsigned key) {
  LabelVolume volume{{.size = size}, {}};
  std::mt19937 random(key);
  volume.voxels.resize(volume.grid.voxel_count());
  for (auto& label : volume.voxels) label = random() < air * 4294967296.0 ? 0 : 1 + random() % labels;
  return volume;
}

// Counts voxels of one label that steps from `start` reach, across faces (6) or also across edges and corners (26).
//   seen            out: 1 for each voxel that was counted
//   reaches_border  out: set to true if a step across a face would leave the grid
std::int64_t flood(const LabelVolume& volume, std::vector<char>& seen, const glm::ivec3& start, int connectivity,
                   bool* reaches_border) {
  const Label label = volume.at(start);
  std::vector<glm::ivec3> open{start};
  seen[volume.grid.index(start)] = 1;
  std::int64_t count = 0;
  while (!open.empty()) {
    const glm::ivec3 v = open.back();
    open.pop_back();
    ++count;
    for (int k = 0; k < 27; ++k) {
      const glm::ivec3 step(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const int length = std::abs(step.x) + std::abs(step.y) + std::abs(step.z);
      if (length == 0 || (connectivity == 6 && length > 1)) continue;
      const glm::ivec3 next = v + step;
      if (!volume.grid.contains(next)) {
        *reaches_border |= length == 1;
      } else if (volume.at(next) == label && !seen[volume.grid.index(next)]) {
        seen[volume.grid.index(next)] = 1;
        open.push_back(next);
      }
    }
  }
  return count;
}

LabelCensus census_by_flooding(const LabelVolume& volume, std::int64_t smallest) {
  LabelCensus census{std::vector<std::int64_t>(65536), std::vector<int>(65536), std::vector<int>(65536),
                     std::vector<std::int64_t>(65536)};
  std::vector<char> seen(volume.voxels.size());
  const glm::ivec3 size = volume.grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::ivec3 v(x, y, z);
        const Label label = volume.at(v);
        ++census.voxels[label];
        bool open = false;
        for (int axis = 0; axis < 3; ++axis)
          for (int side : {-1, 1}) {
            glm::ivec3 beside = v;
            beside[axis] += side;
            open |= volume.at_or_air(beside) == 0;
          }
        if (label && open) ++census.surface_voxels[label];
        if (seen[volume.grid.index(v)]) continue;
        bool border = false;
        const std::int64_t voxels = flood(volume, seen, v, label ? 26 : 6, &border);
        if (label && voxels >= smallest) ++census.components[label];
        if (label && 2 * voxels >= smallest) ++census.half_components[label];
        if (!label && !border) census.enclosed_air_voxels += voxels;
      }
  return census;
}

TissueTable table() {
  TissueTable tissues;
  tissues.tissues.push_back({.label = 1, .file_value = 143, .name = "skin", .kind = TissueKind::Skin, .density = 1.1});
  tissues.tissues.push_back({.label = 2, .file_value = 5, .name = "fat", .kind = TissueKind::Fat, .density = 0.9});
  return tissues;
}

void fill(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label label) {
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) volume.at({x, y, z}) = label;
}
}  // namespace

TEST_CASE("metrics: voxels, components, surface and enclosed air equal what flooding voxel by voxel finds" *
          doctest::test_suite("slow")) {
  for (const glm::ivec3 size :
       {glm::ivec3(17, 13, 11), glm::ivec3(1, 1, 1), glm::ivec3(1, 30, 5), glm::ivec3(40, 3, 9)})
    for (const double air : {0.05, 0.3, 0.7, 0.95})
      for (const int labels : {1, 3}) {
        const LabelVolume volume = random_volume(size, labels, air, static_cast<unsigned>(100 * air + labels));
        for (const std::int64_t smallest : {1, 3, 50}) {
          const LabelCensus census = take_census(volume, smallest), truth = census_by_flooding(volume, smallest);
          CHECK(census.surface_voxels == truth.surface_voxels);
          CHECK(census.enclosed_air_voxels == truth.enclosed_air_voxels);
          bool equal = true;
          for (int label = 1; label < 65536; ++label)
            equal &= census.components[label] == truth.components[label] &&
                     census.half_components[label] == truth.half_components[label] &&
                     census.voxels[label] == truth.voxels[label];
          CHECK(equal);
        }
      }
}

TEST_CASE("metrics: a snake that folds back on itself is one component") {
  LabelVolume volume{{.size = {41, 5, 41}}, ZeroedVector<Label>(41 * 5 * 41)};
  for (int z = 0; z < 41; z += 2) {
    fill(volume, {0, 2, z}, {41, 3, z + 1}, 7);
    if (z + 2 < 41) fill(volume, {z % 4 ? 0 : 40, 2, z + 1}, {z % 4 ? 1 : 41, 3, z + 2}, 7);
  }
  CHECK(take_census(volume, 1).components[7] == 1);
}

TEST_CASE("metrics: a volume compared with itself has changed nowhere, on any grid") {
  const LabelVolume volume = random_volume({12, 12, 12}, 2, 0.3, 5);
  LabelVolume moved{{.size = {20, 18, 16}, .origin = {5, 6, 7}}, ZeroedVector<Label>(20 * 18 * 16)};
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x) moved.at({x + 3, y + 2, z + 1}) = volume.at({x, y, z});
  for (const LabelVolume* after : {&volume, static_cast<const LabelVolume*>(&moved)}) {
    const VolumeMetrics metrics = compare(volume, *after, table());
    CHECK(metrics.volume_change_percent == 0);
    CHECK(metrics.mass_change_percent == 0);
    CHECK(metrics.skin_share_before == metrics.skin_share_after);
    REQUIRE(metrics.tissues.size() == 2);
    CHECK(metrics.tissues[0].file_value == 143);
    for (const TissueChange& tissue : metrics.tissues) {
      CHECK(tissue.volume_change_percent == 0);
      CHECK(tissue.components_before == tissue.components_after);
    }
  }
}

TEST_CASE("metrics: volume and mass change by hand, over different spacings") {
  LabelVolume before{{.size = {10, 10, 10}, .spacing = {2, 2, 2}}, ZeroedVector<Label>(1000)};
  fill(before, {1, 1, 1}, {9, 9, 9}, 1);
  fill(before, {2, 2, 2}, {8, 8, 8}, 2);
  fill(before, {4, 4, 4}, {5, 5, 5}, 0);
  LabelVolume after{{.size = {10, 10, 10}, .spacing = {1, 2, 4}}, ZeroedVector<Label>(1000)};
  fill(after, {1, 1, 1}, {9, 9, 9}, 2);
  const VolumeMetrics metrics = compare(before, after, table());
  REQUIRE(metrics.tissues.size() == 2);
  CHECK(metrics.tissues[0].voxels_before == 512 - 216);
  CHECK(metrics.tissues[0].volume_change_percent == -100);
  CHECK(metrics.tissues[0].components_after == 0);
  CHECK(metrics.tissues[1].mm3_before == 215 * 8);
  CHECK(metrics.tissues[1].volume_change_percent == doctest::Approx(100.0 * (512 - 215) / 215));
  CHECK(metrics.mass_before == doctest::Approx((296 * 1.1 + 215 * 0.9) * 8 / 1000));
  CHECK(metrics.skin_share_before == doctest::Approx(double(512 - 216) / (512 - 216 + 6)));
  CHECK(metrics.skin_share_after == 0);
  CHECK(metrics.enclosed_air_before == 1);
  CHECK(metrics.trapped_air_voxels == 0);
}

TEST_CASE("metrics: air that a fold has closed off is trapped") {
  LabelVolume before{{.size = {12, 12, 12}}, ZeroedVector<Label>(1728)}, after = before;
  fill(before, {2, 2, 2}, {10, 10, 6}, 2);
  fill(after, {2, 2, 2}, {10, 10, 10}, 2);
  fill(after, {4, 4, 4}, {6, 6, 6}, 0);
  CHECK(compare(before, after, table()).trapped_air_voxels == 8);
}

TEST_CASE(
    "metrics: a label that fell apart is torn, one whose piece grew by a voxel or was parted by a single voxel is "
    "not") {
  LabelVolume whole{{.size = {30, 12, 12}}, ZeroedVector<Label>(30 * 12 * 12)};
  fill(whole, {2, 3, 3}, {26, 8, 8}, 1);
  const auto torn = [&](const LabelVolume& before, const LabelVolume& after) {
    return compare(before, after, table()).tissues.at(0).torn_parts;
  };
  LabelVolume gap = whole, tear = whole;
  fill(gap, {13, 3, 3}, {14, 8, 8}, 0);
  fill(tear, {13, 3, 3}, {15, 8, 8}, 0);
  CHECK(torn(whole, whole) == 0);
  CHECK(torn(whole, gap) == 0);
  CHECK(torn(whole, tear) == 1);
  CHECK(torn(tear, whole) == 0);

  LabelVolume speck = whole, grown = whole;
  fill(speck, {28, 3, 3}, {29, 10, 10}, 1);
  fill(grown, {28, 3, 3}, {29, 10, 10}, 1);
  grown.at({28, 10, 9}) = grown.at({28, 10, 8}) = 1;
  CHECK(torn(speck, grown) == 0);

  LabelVolume finer = tear;
  finer.grid.spacing = glm::dvec3(0.5);
  CHECK_FALSE(torn(whole, finer));
}
