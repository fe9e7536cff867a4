// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/edit_mask.h"

namespace limber {

MaskedGrid::MaskedGrid(const EditMask& mask, const Grid& grid) : mask_(mask) {
  if (!mask_.image) return;
  same_grid_ = mask_.image->grid == grid;
  const AffineTransform to_world = world_from_voxel(grid), to_image = voxel_from_world(mask_.image->grid);
  image_from_voxel_ = {to_image.linear * to_world.linear, to_image * to_world.offset};
}

bool MaskedGrid::in_window(const glm::ivec3& voxel) const {
  const glm::ivec3 at = same_grid_ ? voxel : glm::ivec3(glm::floor(image_from_voxel_ * glm::dvec3(voxel) + 0.5));
  if (!mask_.image->grid.contains(at)) return false;
  const double value = mask_.image->value_at(at);
  return value >= mask_.low && value <= mask_.high;
}

}  // namespace limber
