// SPDX-License-Identifier: AGPL-3.0-or-later
// What changed between a volume before and after posing. Errors can cancel in a total: per-tissue numbers lead.
// Volumes may lie on different grids and have different spacings; changes are of volume (mm3), not of voxel counts.
//
// Everything is counted in one sweep over the runs of equal labels along x, with a union-find over the runs
// [He, Chao & Suzuki 2008]: a run joins those of the neighbouring rows that it touches, so memory is two slices of
// runs and a few bytes per place where a component begins.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// What one volume holds.
struct LabelCensus {
  std::vector<std::int64_t> voxels;          // [65536] by label
  std::vector<int> components;               // [65536] 26-connected, of `smallest` voxels or more
  std::vector<int> half_components;          // [65536] the same of half as many
  std::vector<std::int64_t> surface_voxels;  // [65536] tissue voxels with a face towards air or the grid's outside
  std::int64_t enclosed_air_voxels = 0;      // air that no path of air (6-connected) joins to the grid's border
};
LabelCensus take_census(const LabelVolume& volume, std::int64_t smallest = 50);

struct TissueChange {
  Label label;
  double file_value = 0;  // what the label is called in files
  std::string name;
  TissueKind kind = TissueKind::Unknown;
  std::int64_t voxels_before = 0, voxels_after = 0;
  double mm3_before = 0, mm3_after = 0;
  double mass_before = 0, mass_after = 0;  // g
  double volume_change_percent = 0, mass_change_percent = 0;
  int components_before = 0, components_after = 0;  // 26-connected, of 50 voxels or more
  // Pieces of 50 voxels or more beyond those that had half as many before: a piece that grew by a voxel is no tear.
  // None where the two volumes have voxels of different size.
  std::optional<int> torn_parts;
};

struct VolumeMetrics {
  std::vector<TissueChange> tissues;  // those present before or after, by label
  std::int64_t voxels_before = 0, voxels_after = 0;
  double mm3_before = 0, mm3_after = 0;
  double mass_before = 0, mass_after = 0;  // g
  double volume_change_percent = 0, mass_change_percent = 0;
  std::int64_t enclosed_air_before = 0, enclosed_air_after = 0;  // voxels
  std::int64_t trapped_air_voxels = 0;                           // enclosed air that was not enclosed before
  double skin_share_before = 0, skin_share_after = 0;            // of surface voxels; only if there is skin
  bool has_skin = false;
};

// Both volumes with the labels of `tissues`. A tissue that was absent before has no change in percent (0).
VolumeMetrics compare(const LabelVolume& before, const LabelVolume& after, const TissueTable& tissues);

}  // namespace limber
