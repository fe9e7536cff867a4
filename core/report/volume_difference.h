// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where two volumes of one body differ: for each tissue voxel of one volume, the label of the other volume at the
// voxel's centre is read. The volumes may have different grids; if these are aligned, the comparison is exact.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

enum class Differs : std::uint8_t {
  Not,     // the other volume has the same label
  Tissue,  // the other volume has another tissue
  Air,     // the other volume has air
};

// The voxels of one volume that differ from the other volume.
struct DifferingSide {
  struct Count {
    std::int64_t other_tissue = 0, air = 0;

    std::int64_t both() const { return other_tissue + air; }
    bool operator==(const Count&) const = default;
  };
  std::vector<Differs> voxels;    // one value per tissue voxel of this volume, in the order of TissueVoxels
  std::map<Label, Count> counts;  // number of differing voxels, by label of this volume
  Count total;

  bool operator==(const DifferingSide&) const = default;
};

// Returns which tissue voxels of `volume` have another label in `from`, and their numbers.
//   tissue  the tissue voxels of `volume`
DifferingSide differing(const LabelVolume& volume, const TissueVoxels& tissue, const LabelVolume& from);

}  // namespace limber
