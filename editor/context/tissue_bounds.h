// SPDX-License-Identifier: AGPL-3.0-or-later
// How far each tissue reaches in a volume: one pass over the voxels, made when a volume is opened, so that framing and
// jumping to a tissue cost nothing.
#pragma once

#include <memory>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber::editor {

struct VoxelBox {
  glm::ivec3 low{1 << 30}, high{-1};  // first and last voxel; high < low: none

  bool empty() const { return high.x < low.x; }
  void add(const VoxelBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
};

struct Extents {
  std::shared_ptr<const LabelVolume> volume;
  std::vector<VoxelBox> boxes;  // by label
};
Extents extents_of(std::shared_ptr<const LabelVolume> volume);

}  // namespace limber::editor
