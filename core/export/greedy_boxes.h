// SPDX-License-Identifier: AGPL-3.0-or-later
// Divides the tissue of a label volume into few boxes, each with a single label. A box starts at the first tissue voxel
// that is in no box yet. It is extended along x as far as the voxels have the first voxel's label, then along y by
// whole rows and along z by whole layers that have only this label.
#pragma once

#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

struct LabelBox {
  glm::ivec3 low{0}, high{0};  // voxels low .. high - 1 along each axis
  Label label = 0;
};

// Returns the boxes, each with a single label. Every tissue voxel is in exactly one box, air is in none.
std::vector<LabelBox> greedy_boxes(const LabelVolume& volume);

}  // namespace limber
