// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/tiled_labels.h"

#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "core/resample/neighbourhood.h"
#include "core/volume/connected_components.h"
#include "core/volume/label_view.h"

using namespace limber;

namespace {

// Makes random blobs of three labels in air, in a size that does not fill the last tiles.
LabelVolume blobs(const glm::ivec3& size, unsigned seed) {
  std::mt19937 random(seed);
  LabelVolume volume{{.size = size}, ZeroedVector<Label>(std::size_t(size.x) * size.y * size.z)};
  for (int blob = 0; blob < 40; ++blob) {
    const glm::dvec3 centre(random() % size.x, random() % size.y, random() % size.z);
    const double radius = 1 + random() % 6;
    for (std::int64_t at = 0; at < volume.grid.voxel_count(); ++at)
      if (const glm::ivec3 v = voxel_at(volume.grid, at); glm::distance(glm::dvec3(v), centre) < radius)
        volume.voxels[at] = static_cast<Label>(1 + blob % 3);
  }
  return volume;
}

TiledLabels in_tiles(const LabelVolume& volume) {
  TiledLabels tiles(volume.grid);
  for (std::int64_t at = 0; at < volume.grid.voxel_count(); ++at)
    if (volume.voxels[at]) tiles.at(voxel_at(volume.grid, at)) = volume.voxels[at];
  return tiles;
}

}  // namespace

TEST_CASE("tiled labels: every voxel and row reads as in rows, and laid in rows they are the same volume") {
  for (const glm::ivec3 size : {glm::ivec3(37, 21, 19), glm::ivec3(16, 16, 8), glm::ivec3(1, 50, 3)}) {
    const LabelVolume volume = blobs(size, 1 + size.x);
    const TiledLabels tiles = in_tiles(volume);
    std::int64_t differing = 0;
    for (std::int64_t at = 0; at < volume.grid.voxel_count(); ++at)
      differing += std::as_const(tiles).at(voxel_at(volume.grid, at)) != volume.voxels[at];
    CHECK(differing == 0);
    std::vector<Label> row(size.x);
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y) {
        tiles.copy_row(y, z, row.data());
        differing += !std::equal(row.begin(), row.end(), &volume.voxels[volume.grid.index({0, y, z})]);
      }
    CHECK(differing == 0);
    const LabelVolume again = in_rows(tiles);
    CHECK(again.grid == volume.grid);
    CHECK(again.voxels == volume.voxels);
  }
}

TEST_CASE("tiled labels: what is asked of a voxel's neighbours, and the components, do not depend on the layout") {
  const LabelVolume volume = blobs({45, 35, 26}, 7);
  const TiledLabels tiles = in_tiles(volume);
  std::int64_t differing = 0;
  for (std::int64_t at = 0; at < volume.grid.voxel_count(); ++at) {
    const glm::ivec3 v = voxel_at(volume.grid, at);
    differing += is_simple_point(volume, v) != is_simple_point(tiles, v);
    differing += is_enclosed(volume, v) != is_enclosed(tiles, v);
    differing += touches_air(volume, v) != touches_air(tiles, v);
    differing += air_can_change(volume, v) != air_can_change(tiles, v);
    for (Label label : {1, 2, 3}) differing += can_join(volume, v, label) != can_join(tiles, v, label);
  }
  CHECK(differing == 0);
  const Components of_rows = connected_components(volume), of_tiles = connected_components(tiles);
  CHECK(of_rows.voxels == of_tiles.voxels);
  CHECK(of_rows.voxels.size() > 3);
  CHECK(of_rows.first_run == of_tiles.first_run);
}

TEST_CASE("tiled labels: an edit of one layout is read by its views") {
  TiledLabels tiles(Grid{.size = {20, 20, 20}});
  const LabelEdit edit(tiles);
  edit.at({17, 3, 9}) = 5;
  CHECK(LabelView(tiles).at({17, 3, 9}) == 5);
  CHECK(tiles.at({17, 3, 9}) == 5);
  CHECK(LabelView(tiles).at_or_air({20, 3, 9}) == 0);
  CHECK(edit.is_of_same(LabelView(tiles)));
}
