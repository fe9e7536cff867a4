// SPDX-License-Identifier: AGPL-3.0-or-later
// Removes islands: pieces of a label that are separate from its rest. Voxels that share a face, an edge or a corner
// belong to one piece (core/volume/connected_components.h).
#pragma once

#include "core/label_edit/surroundings.h"

namespace limber {

struct KeptIslands {
  int largest = 1;          // the number of largest pieces that stay; 0: no limit
  double least_volume = 0;  // mm3; smaller pieces are removed, even if they are among the largest
  Erased erased = Erased::Surroundings;
};

struct RemovedIslands {
  LabelChange change;
  int removed = 0, kept = 0;  // numbers of pieces
};

// Of pieces with equally many voxels, those with the earlier first voxel count as larger.
RemovedIslands remove_islands(const LabelVolume& volume, Label label, const KeptIslands& kept);

}  // namespace limber
