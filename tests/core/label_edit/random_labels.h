// SPDX-License-Identifier: AGPL-3.0-or-later
// Small volumes for tests of label edits: labels at random, and balls, on a grid that is anisotropic and oblique.
#pragma once

#include <functional>
#include <random>

#include "core/volume/label_volume.h"

namespace limber::test {

inline Grid oblique_grid(const glm::ivec3& size, const glm::dvec3& spacing = {1, 1.5, 2.5}) {
  const double angle = 0.4;
  const glm::dmat3 turned(glm::dvec3(std::cos(angle), std::sin(angle), 0),
                          glm::dvec3(-std::sin(angle), std::cos(angle), 0), glm::dvec3(0, 0, 1));
  return {size, spacing, {-7, 11, 3}, turned};
}

inline LabelVolume volume_of(const Grid& grid, const std::function<Label(const glm::ivec3&)>& label) {
  LabelVolume volume{grid, {}};
  volume.voxels.resize(static_cast<std::size_t>(grid.voxel_count()));
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) volume.at({x, y, z}) = label({x, y, z});
  return volume;
}

// Makes lumps of the labels 0 to labels - 1, each a few voxels wide.
inline LabelVolume random_labels(const Grid& grid, int labels, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, labels - 1);
  const LabelVolume coarse = volume_of({(grid.size + 2) / 3}, [&](const glm::ivec3&) { return Label(any(random)); });
  std::bernoulli_distribution odd(0.15);
  return volume_of(grid, [&](const glm::ivec3& v) { return odd(random) ? Label(any(random)) : coarse.at(v / 3); });
}

inline void for_voxels(const Grid& grid, const std::function<void(const glm::ivec3&)>& act) {
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) act({x, y, z});
}

}  // namespace limber::test
