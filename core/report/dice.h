// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures, for each label, how well two volumes with the same grid agree, by Dice's coefficient [Dice 1945]:
//   2 |A and B| / (|A| + |B|)
// where A is the set of voxels with the label in the first volume, and B that in the second. It is 1 if A and B are
// equal.
#pragma once

#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// Returns Dice's coefficient of each label, 65536 values; 0: neither volume has the label. Both volumes must have the
// same grid.
std::vector<double> dice_by_label(const LabelVolume& a, const LabelVolume& b);

}  // namespace limber
