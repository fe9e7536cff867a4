// SPDX-License-Identifier: AGPL-3.0-or-later
// Fills holes of a label: voxels of other labels that the label encloses. Enclosed are the voxels from which no path
// through faces of voxels without the label leads out of the box around the label. A gap in the label that is closed
// only by edges or corners lets no path through.
#pragma once

#include "core/label_edit/edit_mask.h"
#include "core/label_edit/label_change.h"

namespace limber {

struct HolesToFill {
  double largest_volume = 0;  // mm3; larger holes stay; 0: no limit
  bool only_air = false;      // true: holes that have any tissue in them stay
};

struct FilledHoles {
  LabelChange change;
  int filled = 0, left = 0;  // numbers of holes
};
FilledHoles fill_holes(const LabelVolume& volume, Label label, const HolesToFill& holes);

}  // namespace limber
