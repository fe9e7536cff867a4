// SPDX-License-Identifier: AGPL-3.0-or-later
// Where two volumes of one body differ: each tissue voxel of either is looked up in the other, at its middle. Volumes
// may lie on different grids; where those are aligned the middles are voxels of both, and the lookup is exact.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

enum class Differs : std::uint8_t {
  Not,     // the same label there
  Tissue,  // another tissue there
  Air,     // nothing there
};

// One volume as held against the other.
struct DifferingSide {
  struct Count {
    std::int64_t other_tissue = 0, air = 0;

    std::int64_t both() const { return other_tissue + air; }
    bool operator==(const Count&) const = default;
  };
  std::vector<Differs> voxels;    // #tissue voxels, in their order
  std::map<Label, Count> counts;  // of this volume's labels that differ anywhere
  Count total;

  bool operator==(const DifferingSide&) const = default;
};

//   tissue  of `volume`
DifferingSide differing(const LabelVolume& volume, const TissueVoxels& tissue, const LabelVolume& from);

}  // namespace limber
