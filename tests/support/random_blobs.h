// SPDX-License-Identifier: AGPL-3.0-or-later
// A volume of random labels in touching pieces: each voxel has the label of the nearest seed point. Label 0 (air) is
// one of the random labels.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber::test {

// Returns a volume of `size` voxels with that many seed points.
//   labels  number of labels besides air
inline LabelVolume random_blobs(std::mt19937& random, const glm::ivec3& size, int seeds, Label labels) {
  LabelVolume volume{{.size = size}, ZeroedVector<Label>(std::size_t(size.x) * size.y * size.z)};
  std::vector<std::pair<glm::ivec3, Label>> all;
  for (int s = 0; s < seeds; ++s) {
    glm::ivec3 at;
    for (int k = 0; k < 3; ++k) at[k] = int(random() % unsigned(size[k]));
    all.push_back({at, Label(random() % (labels + 1u))});
  }
  for (std::int64_t i = 0; i < volume.grid.voxel_count(); ++i) {
    const glm::ivec3 v(i % size.x, i / size.x % size.y, i / (size.x * size.y));
    int nearest = 1 << 20;
    for (const auto& [at, label] : all) {
      const glm::ivec3 d = v - at;
      if (const int squared = d.x * d.x + d.y * d.y + d.z * d.z; squared < nearest)
        nearest = squared, volume.voxels[i] = label;
    }
  }
  return volume;
}

}  // namespace limber::test
