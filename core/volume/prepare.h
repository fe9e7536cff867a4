// SPDX-License-Identifier: AGPL-3.0-or-later
// Making a volume ready: re-gridding, orientation, cropping, padding, merging labels, dropping specks, statistics.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/volume/label_volume.h"
#include "core/volume/tissue_table.h"

namespace limber {

// Re-gridding gives each voxel the label with the largest volume share of its box, and keeps layers thinner than a
// voxel closed (a skin of 1 mm stays a closed skin at 4 mm).
LabelVolume regrid(const LabelVolume& volume, const TissueTable& tissues, const glm::dvec3& spacing, Progress& progress = no_progress());
// The body mirrored along a world axis (0, 1, 2 = x, y, z); voxels keep their grid.
LabelVolume flip(const LabelVolume& volume, int axis);
// Voxel axes turned to the nearest axes of `code` ("LPS", "RAS" ...), exactly: no voxel is resampled, none moves in the world.
LabelVolume reorient(const LabelVolume& volume, const std::string& code);
LabelVolume crop_to_tissue(const LabelVolume& volume);
LabelVolume pad(const LabelVolume& volume, int voxels);
LabelVolume merge_labels(const LabelVolume& volume, Label from, Label into);
// Connected pieces (26) of one label with fewer than `voxels` voxels take the label most common around them.
LabelVolume drop_specks(const LabelVolume& volume, int voxels);

struct LabelStatistics {
  Label label;
  std::int64_t voxels = 0;
  double volume_mm3 = 0;
  glm::dvec3 centre{0};          // world, mm
  glm::ivec3 lowest{0}, highest{0};  // bounding box, voxels
  int components = 0;            // 26-connected
  std::int64_t surface_voxels = 0;  // with a 6-neighbour of another label
};
std::vector<LabelStatistics> label_statistics(const LabelVolume& volume);
std::string to_csv(const std::vector<LabelStatistics>& statistics, const TissueTable& tissues);

}  // namespace limber
