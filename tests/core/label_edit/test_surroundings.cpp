// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/surroundings.h"

#include <algorithm>
#include <map>

#include <doctest/doctest.h>

#include "tests/core/label_edit/random_labels.h"

using namespace limber;
using namespace limber::test;

namespace {

// Does the same as filled_from_around() in core, directly from its definition: visits the whole volume for each layer.
LabelVolume filled_slowly(LabelVolume volume, std::vector<std::int64_t> open, Label label) {
  const Grid grid = volume.grid;
  std::vector<std::uint8_t> waits(volume.voxels.size(), 0);
  for (const std::int64_t v : open) waits[static_cast<std::size_t>(v)] = 1;
  for (;;) {
    std::map<std::int64_t, Label> layer;
    for_voxels(grid, [&](const glm::ivec3& v) {
      if (!waits[static_cast<std::size_t>(grid.index(v))]) return;
      std::map<Label, std::pair<int, int>> votes;
      for_voxels({glm::ivec3(3)}, [&](const glm::ivec3& n) {
        const glm::ivec3 at = v + n - 1;
        if (at == v || !grid.contains(at)) return;
        if (waits[static_cast<std::size_t>(grid.index(at))] || volume.at(at) == label) return;
        auto& [all, faces] = votes[volume.at(at)];
        ++all;
        const glm::ivec3 off = glm::abs(n - 1);
        faces += off.x + off.y + off.z == 1;
      });
      if (votes.empty()) return;
      const auto best = std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) {
        return std::tuple(a.second.first, a.second.second, -a.first) <
               std::tuple(b.second.first, b.second.second, -b.first);
      });
      layer[grid.index(v)] = best->first;
    });
    if (layer.empty()) break;
    for (const auto& [v, l] : layer)
      volume.voxels[static_cast<std::size_t>(v)] = l, waits[static_cast<std::size_t>(v)] = 0;
  }
  for (const std::int64_t v : open)
    if (waits[static_cast<std::size_t>(v)]) volume.voxels[static_cast<std::size_t>(v)] = 0;
  return volume;
}

}  // namespace

TEST_CASE("surroundings: voxels are filled as the definition says, layer by layer") {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const LabelVolume volume = random_labels({{15, 13, 11}}, seed % 2 ? 3 : 5, seed);
    std::mt19937 random(seed);
    std::vector<std::int64_t> voxels;
    for (std::size_t v = 0; v < volume.voxels.size(); ++v)
      if (volume.voxels[v] == 1 && random() % 10 < 8) voxels.push_back(static_cast<std::int64_t>(v));
    LabelVolume filled = volume;
    apply_change(filled_from_around(volume, voxels, 1), filled);
    CHECK(filled.voxels == filled_slowly(volume, voxels, 1).voxels);
  }
}

TEST_CASE("surroundings: erasing into air makes air, and nothing erased changes nothing") {
  const LabelVolume volume = random_labels({{8, 8, 8}}, 3, 1);
  std::vector<std::int64_t> voxels;
  for (std::size_t v = 0; v < volume.voxels.size(); ++v)
    if (volume.voxels[v] == 2) voxels.push_back(static_cast<std::int64_t>(v));
  LabelVolume erased = volume;
  apply_change(erased_voxels(volume, voxels, 2, Erased::Air), erased);
  for (std::size_t v = 0; v < volume.voxels.size(); ++v)
    CHECK(erased.voxels[v] == (volume.voxels[v] == 2 ? 0 : volume.voxels[v]));
  CHECK(filled_from_around(volume, {}, 2).empty());
}
