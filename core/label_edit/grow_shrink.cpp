// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/grow_shrink.h"

#include <cmath>
#include <stdexcept>

#include "core/base/parallel.h"

namespace limber {

namespace {

// Returns the square of a limit on distances, slightly enlarged, so that distances equal to the limit count as within
// it in spite of rounding errors (up to 1e-6 in distance_transform.h).
float squared_limit(double mm) { return static_cast<float>(mm * mm * (1 + 4e-6)); }

// Returns one byte for each voxel of the box, 1 if the voxel has the label (`has` 1) or another label (`has` 0).
std::vector<std::uint8_t> voxels_with(const LabelVolume& volume, Label label, const VoxelBox& box, int has) {
  std::vector<std::uint8_t> marked(static_cast<std::size_t>(box.voxel_count()));
  parallel_for(box.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t z = begin; z < end; ++z)
      for (int y = 0; y < box.size.y; ++y) {
        const glm::ivec3 first = box.lowest + glm::ivec3(0, y, z);
        const Label* row = &volume.voxels[volume.grid.index(first)];
        std::uint8_t* to = &marked[static_cast<std::size_t>(box.index(first))];
        for (int x = 0; x < box.size.x; ++x) to[x] = (row[x] == label) == (has != 0);
      }
  });
  return marked;
}

}  // namespace

LabelChange grown_label(const LabelVolume& volume, Label label, double mm, const EditMask& mask, Progress& progress) {
  if (!(mm >= 0)) throw std::logic_error("a label grows by a distance of at least 0");
  const VoxelBox box = label_box(volume, label, glm::ivec3(glm::ceil(mm / volume.grid.spacing)));
  if (box.size.x == 0) return {};
  const std::vector<float> squared =
      squared_distance(box, voxels_with(volume, label, box, 1), volume.grid.spacing, progress);
  const MaskedGrid allowed(mask, volume.grid);
  const float most = squared_limit(mm);
  return change_by_rows(box, [&](int y, int z, LabelChange& change) {
    const glm::ivec3 first(box.lowest.x, y, z);
    const std::int64_t voxel = volume.grid.index(first);
    const float* near = &squared[static_cast<std::size_t>(box.index(first))];
    for (int x = 0; x < box.size.x; ++x) {
      const Label was = volume.voxels[static_cast<std::size_t>(voxel + x)];
      if (was != label && near[x] <= most && allowed.allows(first + glm::ivec3(x, 0, 0), was))
        change.add(voxel + x, was, label);
    }
  });
}

LabelChange shrunk_label(const LabelVolume& volume, Label label, double mm, Erased erased, Progress& progress) {
  if (!(mm >= 0)) throw std::logic_error("a label shrinks by a distance of at least 0");
  const VoxelBox box = label_box(volume, label, glm::ivec3(1));
  if (box.size.x == 0) return {};
  const std::vector<float> squared =
      squared_distance(box, voxels_with(volume, label, box, 0), volume.grid.spacing, progress);
  const float most = squared_limit(mm);
  std::vector<std::int64_t> voxels;
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y) {
      const glm::ivec3 first = box.lowest + glm::ivec3(0, y, z);
      const std::int64_t voxel = volume.grid.index(first);
      const float* near = &squared[static_cast<std::size_t>(box.index(first))];
      for (int x = 0; x < box.size.x; ++x)
        if (near[x] > 0 && near[x] <= most) voxels.push_back(voxel + x);
    }
  return erased_voxels(volume, voxels, label, erased);
}

}  // namespace limber
