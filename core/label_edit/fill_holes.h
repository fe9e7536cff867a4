// SPDX-License-Identifier: AGPL-3.0-or-later
// Fills the holes of a label: voxels of other labels that the label encloses. A voxel is enclosed if no path from the
// voxel, through the faces of voxels without the label, leads out of the label's bounding box. Voxels of the label that
// meet only at an edge or a corner already block such paths.
#pragma once

#include "core/label_edit/edit_mask.h"
#include "core/label_edit/label_change.h"

namespace limber {

struct HolesToFill {
  double largest_volume = 0;  // mm3; larger holes are not filled; 0: no limit
  bool only_air = false;      // true: holes that contain any tissue are not filled
};

struct FilledHoles {
  LabelChange change;
  int filled = 0, left = 0;  // number of holes that were filled, and of those that were not
};
FilledHoles fill_holes(const LabelVolume& volume, Label label, const HolesToFill& holes);

}  // namespace limber
