// SPDX-License-Identifier: AGPL-3.0-or-later
// Selects the voxels that an edit of labels may change: only those with certain labels, and only those whose value in a
// grey image (CT, MR) lies in a window. For example, bone may be painted only where the CT is denser than 200 HU.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/volume/grey_levels.h"
#include "core/volume/label_volume.h"

namespace limber {

struct EditMask {
  // One byte for each label 0 .. 65535, air included: not 0 for labels whose voxels may change. Empty: all labels.
  std::vector<std::uint8_t> labels;
  // If set, only voxels whose value in this image lies in [low, high] may change; null: all may. The image may have
  // another grid. A voxel has the value of the image voxel nearest to its centre, and may not change outside of the
  // image.
  std::shared_ptr<const GreyLevels> image;
  double low = 0, high = 0;
};

// Applies a mask to the voxels of one grid: tells which of them may change.
class MaskedGrid {
 public:
  MaskedGrid(const EditMask& mask, const Grid& grid);

  bool allows(const glm::ivec3& voxel, Label label) const {
    return (mask_.labels.empty() || mask_.labels[label]) && (!mask_.image || in_window(voxel));
  }

 private:
  bool in_window(const glm::ivec3& voxel) const;

  EditMask mask_;
  bool same_grid_ = false;
  AffineTransform image_from_voxel_;
};

}  // namespace limber
