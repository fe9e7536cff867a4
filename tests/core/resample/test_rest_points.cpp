// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/rest_points.h"

#include <algorithm>

#include <doctest/doctest.h>

using namespace limber;

namespace {

const VoxelRange kOutput{{-5, 3, 10}, {94, 82, 59}};  // two tiles along each axis

// Fills the map: every third voxel is tissue, every seventh of those bone; the tiles from z = 55 on hold none.
void trace(InverseMap& map, const VoxelRange& range) {
  map.reset(range);
  glm::ivec3 v;
  for (v.z = range.low.z; v.z <= range.high.z; ++v.z)
    for (v.y = range.low.y; v.y <= range.high.y; ++v.y)
      for (v.x = range.low.x; v.x <= range.high.x; ++v.x) {
        const int number = v.x + 100 * v.y + 10000 * v.z;
        if (number % 3 || v.z >= 55) continue;
        const std::int64_t at = map.index(v);
        map.use_row(v);
        map.rest[at] = glm::vec3(v) * 0.5f;
        if (number % 7) map.cell[at] = number;
        else map.bone[at] = 2;
      }
}

// Returns the rest points of all voxels of the output.
std::vector<glm::dvec3> all_of(RestPoints& points) {
  std::vector<glm::dvec3> all;
  const glm::ivec3 size = kOutput.high - kOutput.low + 1;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) all.push_back(points.at({x, y, z}));
  return all;
}

void keep_tiles(RestPoints& points) {
  const glm::ivec3 size = kOutput.high - kOutput.low + 1, tiles = (size + RestPoints::kTile - 1) / RestPoints::kTile;
  InverseMap map;
  map.has_volume_ratio = false;
  for (int t = 0; t < tiles.x * tiles.y * tiles.z; ++t) {
    const glm::ivec3 tile(t % tiles.x, t / tiles.x % tiles.y, t / tiles.x / tiles.y);
    const glm::ivec3 low = kOutput.low + RestPoints::kTile * tile;
    trace(map, {low, glm::min(low + RestPoints::kTile - 1, kOutput.high)});
    points.keep(map);
  }
}

}  // namespace

TEST_CASE("rest points: what was kept is what would be traced, with room for all, for some and for none") {
  int traced = 0;
  const auto counting = [&](InverseMap& map, const VoxelRange& range) { ++traced, trace(map, range); };
  RestPoints none(kOutput, 0, counting);
  const std::vector<glm::dvec3> truth = all_of(none);
  const int traced_for_all = traced;
  CHECK(traced_for_all > 0);
  CHECK(std::count_if(truth.begin(), truth.end(), [](const glm::dvec3& p) { return p != glm::dvec3(0); }) > 100'000);
  for (const std::int64_t room : {200'000, 60'000}) {
    traced = 0;
    RestPoints kept(kOutput, room, counting);
    keep_tiles(kept);
    CHECK((all_of(kept) == truth));
    CHECK((room == 200'000 ? traced == 0 : traced > 0));
    CHECK(traced < traced_for_all);
  }
}
