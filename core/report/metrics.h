// SPDX-License-Identifier: AGPL-3.0-or-later
// What changed between a volume before and after posing. Errors can cancel in a total: per-tissue numbers lead.
#pragma once

#include <string>
#include <vector>

#include "core/volume/label_volume.h"
#include "core/volume/tissue_table.h"

namespace limber {

struct TissueChange {
  Label label;
  std::string name;
  std::int64_t voxels_before = 0, voxels_after = 0;
  double mm3_before = 0, mm3_after = 0;
  double volume_change_percent = 0, mass_change_percent = 0;
  int components_before = 0, components_after = 0;  // 26-connected, of 50 voxels or more
};

struct VolumeMetrics {
  std::vector<TissueChange> tissues;
  std::int64_t voxels_before = 0, voxels_after = 0;
  double volume_change_percent = 0;
  std::int64_t trapped_air_voxels = 0;  // enclosed air of `after`
  double skin_share_before = 0, skin_share_after = 0;  // of surface voxels; only if there is skin
  bool has_skin = false;
};

VolumeMetrics compare(const LabelVolume& before, const LabelVolume& after, const TissueTable& tissues);

// Enclosed air: air voxels that no path of air (6-connected) joins to the border. Counted as holes of the volume.
std::int64_t count_enclosed_air(const LabelVolume& volume);
// Number of 26-connected components with at least `smallest` voxels, per label [65536].
std::vector<int> count_components(const LabelVolume& volume, std::int64_t smallest = 50);

}  // namespace limber
