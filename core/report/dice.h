// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures for each label how well two volumes on one grid agree, by Dice's coefficient [Dice 1945]: 2 |A and B| / (|A|
// + |B|) for the voxel sets A and B of the label. It is 1 where they are equal.
#pragma once

#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// Returns the coefficient of each label, 65536 values, 0 where neither volume has the label. Both volumes must have the
// same grid.
std::vector<double> dice_by_label(const LabelVolume& a, const LabelVolume& b);

}  // namespace limber
