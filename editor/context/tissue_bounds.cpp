// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/tissue_bounds.h"

namespace limber::editor {

Extents extents_of(std::shared_ptr<const LabelVolume> volume) {
  Extents extents{volume, std::vector<VoxelBox>(65536)};
  if (!volume) return extents;
  const glm::ivec3 size = volume->grid.size;
  const Label* voxel = volume->voxels.data();
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y, voxel += size.x)
      // Neighbouring voxels along x mostly have the same tissue. To save time, a whole run of equal voxels is added to
      // the tissue's box at once.
      for (int x = 0; x < size.x;) {
        const Label label = voxel[x];
        const int first = x;
        while (x < size.x && voxel[x] == label) ++x;
        if (label != 0) extents.boxes[label].add({{first, y, z}, {x - 1, y, z}});
      }
  return extents;
}

}  // namespace limber::editor
