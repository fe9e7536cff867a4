// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes each tissue's bounding box in voxels, in one pass over a volume. The boxes are stored, so that zooming to a
// tissue does not search the volume again.
#pragma once

#include <memory>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber::editor {

struct VoxelBox {
  glm::ivec3 low{1 << 30}, high{-1};  // lowest and highest voxel of the box; high < low: the box is empty

  bool empty() const { return high.x < low.x; }
  void add(const VoxelBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
};

struct Extents {
  std::shared_ptr<const LabelVolume> volume;
  std::vector<VoxelBox> boxes;  // 65536 boxes, indexed by label
};
Extents extents_of(std::shared_ptr<const LabelVolume> volume);

}  // namespace limber::editor
