// SPDX-License-Identifier: AGPL-3.0-or-later
// Grows and shrinks a label by a distance in mm, which is equal in all directions at any spacing. Distances are exact
// Euclidean distances between voxel centres (core/volume/distance_transform.h), so a distance shorter than the smallest
// spacing changes nothing.
#pragma once

#include "core/base/progress.h"
#include "core/label_edit/edit_mask.h"
#include "core/label_edit/surroundings.h"

namespace limber {

// Gives the label to all voxels at most `mm` from a voxel with the label, if the mask allows their change.
LabelChange grown_label(const LabelVolume& volume, Label label, double mm, const EditMask& mask,
                        Progress& progress = no_progress());
// Removes the label from its voxels that are at most `mm` from a voxel of another label. Voxels outside the grid have
// no label, so the label does not shrink from the grid's border.
LabelChange shrunk_label(const LabelVolume& volume, Label label, double mm, Erased erased,
                         Progress& progress = no_progress());

}  // namespace limber
