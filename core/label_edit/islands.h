// SPDX-License-Identifier: AGPL-3.0-or-later
// Removes islands: connected components of a label that are separate from the rest of the label. Voxels that share a
// face, an edge or a corner are connected (core/volume/connected_components.h).
#pragma once

#include "core/label_edit/surroundings.h"

namespace limber {

struct KeptIslands {
  int largest = 1;          // number of components to keep, the largest first; 0: no limit
  double least_volume = 0;  // mm3; smaller components are removed, even if they are among the largest
  Erased erased = Erased::Surroundings;
};

struct RemovedIslands {
  LabelChange change;
  int removed = 0, kept = 0;  // number of components that were removed, and of those that were kept
};

// Removes the components that `kept` does not keep. Of components with equally many voxels, the one whose first voxel
// comes earlier in the volume counts as larger.
RemovedIslands remove_islands(const LabelVolume& volume, Label label, const KeptIslands& kept);

}  // namespace limber
