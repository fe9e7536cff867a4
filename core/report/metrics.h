// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures what changed between a volume before and after posing. Tissues are compared one by one, since errors can
// cancel in a total. The volumes may have different grids and spacings, so changes are changes of volume (mm3), not of
// voxel counts.
//
// One pass over the runs of equal labels along x counts everything, with a union-find over the runs [He, Chao & Suzuki
// 2008]: each run is united with the runs of its label that it touches in the neighbouring rows. So memory contains
// only the runs of two slices, and a few bytes for each run that starts a new component.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// The counts of one volume. `smallest` is the argument of take_census(), a number of voxels.
struct LabelCensus {
  std::vector<std::int64_t> voxels;          // number of voxels of each of the 65536 labels
  std::vector<int> components;               // by label: 26-connected components with at least `smallest` voxels
  std::vector<int> half_components;          // by label: 26-connected components with at least `smallest` / 2 voxels
  std::vector<std::int64_t> surface_voxels;  // by label: tissue voxels that share a face with air or the grid's border
  std::int64_t enclosed_air_voxels = 0;      // air voxels without a 6-connected path of air to the grid's border
};
LabelCensus take_census(const LabelVolume& volume, std::int64_t smallest = 50);

struct TissueChange {
  Label label;
  double file_value = 0;  // the label's value in the user's files
  std::string name;
  TissueKind kind = TissueKind::Unknown;
  std::int64_t voxels_before = 0, voxels_after = 0;
  double mm3_before = 0, mm3_after = 0;
  double mass_before = 0, mass_after = 0;  // mass of the tissue, g
  double volume_change_percent = 0, mass_change_percent = 0;
  int components_before = 0, components_after = 0;  // number of 26-connected components of 50 voxels or more
  // Number of parts into which posing has torn the tissue: its components of 50 voxels or more after posing minus those
  // of 25 or more before, so that a component that merely grew to 50 does not count. Empty: the two volumes have voxels
  // of different size.
  std::optional<int> torn_parts;
};

struct VolumeMetrics {
  std::vector<TissueChange> tissues;  // tissues that are present before or after, sorted by label
  std::int64_t voxels_before = 0, voxels_after = 0;
  double mm3_before = 0, mm3_after = 0;
  double mass_before = 0, mass_after = 0;  // mass of all tissues, g
  double volume_change_percent = 0, mass_change_percent = 0;
  std::int64_t enclosed_air_before = 0, enclosed_air_after = 0;  // number of air voxels that tissue encloses
  std::int64_t trapped_air_voxels = 0;                           // increase of the enclosed air, voxels; 0: none
  double skin_share_before = 0, skin_share_after = 0;            // fraction of the surface voxels that are skin, [0, 1]
  bool has_skin = false;
};

// Compares the volumes of a body before and after posing, whose labels are those of `tissues`. A tissue that was absent
// before has a change of 0 %.
VolumeMetrics compare(const LabelVolume& before, const LabelVolume& after, const TissueTable& tissues);

}  // namespace limber
