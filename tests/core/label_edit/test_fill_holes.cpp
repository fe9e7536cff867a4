// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/fill_holes.h"

#include <doctest/doctest.h>

#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

namespace {

// Marks the voxels that a flood from the border of the grid, through faces of voxels without the label, does not reach.
std::vector<std::uint8_t> enclosed(const LabelVolume& volume, Label label) {
  const Grid& grid = volume.grid;
  std::vector<std::uint8_t> in(volume.voxels.size(), 1);
  std::vector<glm::ivec3> open;
  const auto visit = [&](const glm::ivec3& v) {
    if (!grid.contains(v) || volume.at(v) == label || !in[static_cast<std::size_t>(grid.index(v))]) return;
    in[static_cast<std::size_t>(grid.index(v))] = 0;
    open.push_back(v);
  };
  for_voxels(grid, [&](const glm::ivec3& v) {
    if (glm::any(glm::equal(v, glm::ivec3(0))) || glm::any(glm::equal(v, grid.size - 1))) visit(v);
  });
  while (!open.empty()) {
    const glm::ivec3 v = open.back();
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        glm::ivec3 n = v;
        n[axis] += step;
        visit(n);
      }
  }
  return in;
}

}  // namespace

TEST_CASE("fill holes: exactly the voxels that the label encloses get it") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LabelVolume volume = random_labels({{19, 17, 15}}, 2 + static_cast<int>(seed % 2), seed);
    const Label label = 1;
    LabelVolume filled = volume;
    apply_change(fill_holes(volume, label, {}).change, filled);
    const auto in = enclosed(volume, label);
    for (std::size_t v = 0; v < volume.voxels.size(); ++v)
      CHECK(filled.voxels[v] == (in[v] ? label : volume.voxels[v]));
  }
}

TEST_CASE("fill holes: large holes and holes with tissue stay when asked, and are counted") {
  // A block of bone with a hole of 27 voxels of air, one of 8 voxels of marrow, and a tunnel to the outside.
  const LabelVolume volume = volume_of({{30, 14, 14}, {1, 1, 2}}, [](const glm::ivec3& v) {
    const auto box = [&](const glm::ivec3& low, int edge) {
      return glm::all(glm::greaterThanEqual(v, low)) && glm::all(glm::lessThan(v, low + edge));
    };
    if (box({5, 5, 5}, 3)) return Label(0);
    if (box({12, 5, 5}, 2)) return Label(2);
    if (v.y == 6 && v.z == 6 && v.x > 17) return Label(0);
    return Label(glm::all(glm::greaterThan(v, glm::ivec3(1))) && glm::all(glm::lessThan(v, glm::ivec3(28, 12, 12))));
  });
  const auto filled = [&](const HolesToFill& wanted) { return fill_holes(volume, 1, wanted); };
  CHECK(filled({}).filled == 2);
  CHECK(filled({}).change.voxel_count() == 35);
  CHECK(filled({.largest_volume = 16}).filled == 1);
  CHECK(filled({.largest_volume = 16}).left == 1);
  CHECK(filled({.largest_volume = 16}).change.voxel_count() == 8);
  CHECK(filled({.largest_volume = 15.9}).filled == 0);
  CHECK(filled({.only_air = true}).change.voxel_count() == 27);
  CHECK(fill_holes(volume, 5, {}).change.empty());
}
