// SPDX-License-Identifier: AGPL-3.0-or-later
// How far two volumes on one grid agree, label by label [Dice 1945]: 2 |A and B| / (|A| + |B|), 1 where they are the
// same.
#pragma once

#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// [65536] by label, 0 where neither has it. Both on the same grid.
std::vector<double> dice_by_label(const LabelVolume& a, const LabelVolume& b);

}  // namespace limber
