// SPDX-License-Identifier: AGPL-3.0-or-later
// A label volume as few boxes: from its lowest voxel that no box has yet, a box grows along x while the label goes on,
// then along y by whole runs, then along z by whole layers.
#pragma once

#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

struct LabelBox {
  glm::ivec3 low{0}, high{0};  // voxels low .. high - 1
  Label label = 0;
};

// Every tissue voxel lies in exactly one box, and every box holds one label. Air has none.
std::vector<LabelBox> greedy_boxes(const LabelVolume& volume);

}  // namespace limber
