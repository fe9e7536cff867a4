// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/islands.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

namespace {

// Three cubes of bone (1) with edges of 6, 4 and 2 voxels in muscle (2), and a fourth with edges of 3 voxels in air.
LabelVolume cubes() {
  return volume_of({{40, 20, 20}, {2, 2, 2}}, [](const glm::ivec3& v) {
    const auto cube = [&](const glm::ivec3& low, int edge) {
      return glm::all(glm::greaterThanEqual(v, low)) && glm::all(glm::lessThan(v, low + edge));
    };
    const bool bone = cube({4, 5, 5}, 6) || cube({14, 5, 5}, 4) || cube({22, 5, 5}, 2) || cube({34, 5, 5}, 3);
    return Label(bone ? 1 : v.x < 30 ? 2 : 0);
  });
}

}  // namespace

TEST_CASE("islands: the largest pieces stay, the others become what surrounds them") {
  const LabelVolume volume = cubes();
  for (int keep = 1; keep <= 5; ++keep) {
    const RemovedIslands result = remove_islands(volume, 1, {.largest = keep});
    CHECK(result.kept == std::min(keep, 4));
    CHECK(result.removed == 4 - std::min(keep, 4));
    LabelVolume after = volume;
    apply_change(result.change, after);
    for_voxels(volume.grid, [&](const glm::ivec3& v) {
      const int rank = v.x < 12 ? 1 : v.x < 20 ? 2 : v.x < 30 ? 4 : 3;
      const Label expected = volume.at(v) != 1 ? volume.at(v) : rank <= keep ? 1 : v.x < 30 ? 2 : 0;
      CHECK(after.at(v) == expected);
    });
  }
}

TEST_CASE("islands: pieces below a volume are removed, in mm3") {
  const LabelVolume volume = cubes();  // islands of 1728, 512, 64 and 216 mm3
  const auto left = [&](const KeptIslands& kept) { return remove_islands(volume, 1, kept).kept; };
  CHECK(left({.largest = 0, .least_volume = 64}) == 4);
  CHECK(left({.largest = 0, .least_volume = 65}) == 3);
  CHECK(left({.largest = 0, .least_volume = 300}) == 2);
  CHECK(left({.largest = 1, .least_volume = 300}) == 1);
  CHECK(left({.largest = 0, .least_volume = 1e6}) == 0);
  CHECK(remove_islands(volume, 1, {.largest = 4}).change.empty());
  CHECK(remove_islands(volume, 77, {}).change.empty());
}

TEST_CASE("islands: pieces that meet at a corner are one piece, and two threads do the same") {
  const LabelVolume corner = volume_of(
      {{6, 6, 6}}, [](const glm::ivec3& v) { return Label(v == glm::ivec3(2, 2, 2) || v == glm::ivec3(3, 3, 3)); });
  CHECK(remove_islands(corner, 1, {}).removed == 0);
  const LabelVolume volume = random_labels({{50, 40, 30}}, 3, 6);
  LabelChange one, two;
  {
    const ThreadCount threads(1);
    one = remove_islands(volume, 1, {.largest = 2}).change;
  }
  {
    const ThreadCount threads(2);
    two = remove_islands(volume, 1, {.largest = 2}).change;
  }
  CHECK_FALSE(one.empty());
  CHECK(one == two);
}
