// SPDX-License-Identifier: AGPL-3.0-or-later
// Splits a label into two by a cut, as with a knife. The cut is a strip of a plane: as wide as the line that the user
// drew across the tissue, and endless along the line of sight. Voxels of the label that share a face are connected
// unless the cut passes between their centres. The connected components on one side of the cut become a new label;
// components that the cut does not touch keep their label. So a cut across one knee does not divide the other leg.
#pragma once

#include "core/label_edit/label_change.h"

namespace limber {

struct LabelCut {
  glm::dvec3 from{0}, to{0};  // the line's ends, world, mm
  glm::dvec3 sight{0, 0, 1};  // direction of the line of sight, world, unit length, not along the line
};

// Returns the change that gives the label `into` to the smaller side of the cut. Throws Error if the cut meets no voxel
// of the label, or if voxels of the label still connect its two sides around the cut.
LabelChange split_label(const LabelVolume& volume, Label label, const LabelCut& cut, Label into);

}  // namespace limber
