// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/label_runs.h"

#include <random>

#include <doctest/doctest.h>

#include "core/volume/tissue_voxels.h"

using namespace limber;

namespace {

// Returns runs of air and of tissue, also with labels that use the highest bit.
std::vector<Label> random_row(int size, unsigned key) {
  std::mt19937 random(key);
  std::vector<Label> row;
  while (std::ssize(row) < size) {
    const bool is_air = random() % 2;
    for (int left = random() % 20; left >= 0; --left) row.push_back(is_air ? 0 : 1 + random() % 65535);
  }
  row.resize(size);
  return row;
}

}  // namespace

TEST_CASE("label runs: air and tissue end where the first other voxel lies") {
  for (unsigned key = 0; key < 40; ++key) {
    const std::vector<Label> row = random_row(61, key);
    for (int x = 0; x < 61; ++x) {
      int air = x, tissue = x;
      while (air < 61 && row[air] == 0) ++air;
      while (tissue < 61 && row[tissue] != 0) ++tissue;
      CHECK(end_of_air(row.data(), x, 61) == air);
      CHECK(end_of_tissue(row.data(), x, 61) == tissue);
    }
  }
}

TEST_CASE("tissue voxels: the list holds what is not air, in a grid that is no whole number of bricks") {
  LabelVolume volume;
  volume.grid.size = {37, 19, 11};
  for (const Label label : random_row(37 * 19 * 11, 7)) volume.voxels.push_back(label);
  const TissueVoxels tissue(volume);
  std::int64_t count = 0, wrong = 0;
  for (int z = 0; z < 11; ++z)
    for (int y = 0; y < 19; ++y)
      for (int x = 0; x < 37; ++x) {
        const bool is_tissue = volume.at({x, y, z}) != 0;
        count += is_tissue;
        wrong += tissue.holds({x, y, z}) != is_tissue;
      }
  CHECK(tissue.size() == count);
  CHECK(wrong == 0);
}
