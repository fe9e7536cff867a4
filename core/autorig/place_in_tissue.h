// SPDX-License-Identifier: AGPL-3.0-or-later
// Places a rig in a volume for which it was not made. Such a rig may have other units or other axes, like Bender's rigs
// or the joints of a BVH file.
#pragma once

#include "core/autorig/auto_rig.h"
#include "core/base/progress.h"

namespace limber {

// Returns the rig scaled to the tissue and centred on it, in the best of 24 rotations by right angles. The best
// rotation brings the largest length of bones, and the largest share of the rig's length, into tissue. A rig whose
// names show head and feet is placed upright. Throws Error for a volume without tissue.
Armature placed_in_tissue(const LabelVolume& volume, const Armature& rig);

// Returns the result of auto_fit() (core/autorig/auto_rig.h). If auto_fit() finds no joint for certain and
// placed_in_tissue() brings more of the rig into tissue, returns the rig from placed_in_tissue() instead, with a
// warning.
AutoFit fitted_or_placed(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig,
                         Progress& progress = no_progress());

}  // namespace limber
