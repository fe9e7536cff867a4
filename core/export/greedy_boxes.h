// SPDX-License-Identifier: AGPL-3.0-or-later
// Divides a label volume into few boxes of one label each. Each box starts at the first voxel that is in no box yet. It
// is extended along x while the label continues, then along y by rows of the same length and label, then along z by
// layers of the same size and label.
#pragma once

#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

struct LabelBox {
  glm::ivec3 low{0}, high{0};  // voxels low .. high - 1 along each axis
  Label label = 0;
};

// Returns boxes of one label each; every tissue voxel is in exactly one box, air is in none.
std::vector<LabelBox> greedy_boxes(const LabelVolume& volume);

}  // namespace limber
