// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the connected components of each tissue label. Voxels of one label that share a face, an edge or a corner
// (26-connected) belong together. The search works on runs (stretches of one label along x) with union-find, so that
// memory grows with the surface of the tissue and not with the number of voxels [Rosenfeld & Pfaltz 1966, on runs].
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_view.h"

namespace limber {

struct Components {
  struct Run {
    std::int32_t begin, end;  // the run's voxels: begin <= x < end
    Label label;              // label of the run; never air
    std::int32_t component;   // component that contains the run, as an index into `voxels`
  };
  std::vector<Run> runs;                // in the order of rows
  std::vector<std::int64_t> first_run;  // #rows + 1: index of the first run of row y + size.y * z
  std::vector<std::int64_t> voxels;  // voxel count of each component; components are in the order of their first voxels
};

// Finds the connected components of the labels in `of_labels` (nullptr: all labels), within the rows in `in_rows`
// (nullptr: all rows). A caller may leave out rows that are known to be air, to save time.
Components connected_components(const LabelView& volume, const RowSet* in_rows = nullptr,
                                const LabelSet* of_labels = nullptr);

}  // namespace limber
