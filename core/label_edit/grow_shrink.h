// SPDX-License-Identifier: AGPL-3.0-or-later
// Grows and shrinks a label by a distance in mm, the same in all directions whatever the spacing. Distances are those
// between voxel centres, exact and Euclidean (core/volume/distance_transform.h), so a distance shorter than the
// smallest spacing changes nothing.
#pragma once

#include "core/base/progress.h"
#include "core/label_edit/edit_mask.h"
#include "core/label_edit/surroundings.h"

namespace limber {

// Gives the label to the voxels within `mm` of one of its voxels, as far as the mask allows.
LabelChange grown_label(const LabelVolume& volume, Label label, double mm, const EditMask& mask,
                        Progress& progress = no_progress());
// Takes the label from its voxels within `mm` of a voxel of another label. What lies beyond the grid is unknown, so the
// label does not shrink from there.
LabelChange shrunk_label(const LabelVolume& volume, Label label, double mm, Erased erased,
                         Progress& progress = no_progress());

}  // namespace limber
