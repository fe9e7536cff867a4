// SPDX-License-Identifier: AGPL-3.0-or-later
// The connected pieces of each tissue label. Voxels of one label that meet by a face, an edge or a corner
// (26-connected) belong together. Found on runs (stretches of one label along x) with union-find, so that memory
// follows the surface of the tissue and not the number of voxels [Rosenfeld & Pfaltz 1966, on runs].
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

struct Components {
  struct Run {
    std::int32_t begin, end;  // x, end excluded
    Label label;              // never air
    std::int32_t component;   // place in `voxels`
  };
  std::vector<Run> runs;                // row by row
  std::vector<std::int64_t> first_run;  // #rows + 1; row y + size.y z
  std::vector<std::int64_t> voxels;     // of each component, in order of its first voxel
};

// Those of the labels and rows that are named; nullptr for all. Rows that are known to be air need not be read.
Components connected_components(const LabelVolume& volume, const RowSet* in_rows = nullptr,
                                const LabelSet* of_labels = nullptr);

}  // namespace limber
