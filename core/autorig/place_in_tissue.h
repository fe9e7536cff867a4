// SPDX-License-Identifier: AGPL-3.0-or-later
// Places rigs of any origin, with other units or other axes, in a volume for which they were not made, such as Bender's
// rigs or the joints of a BVH file.
#pragma once

#include "core/autorig/auto_rig.h"
#include "core/base/progress.h"

namespace limber {

// Returns the rig scaled to the tissue and moved to its middle, in the best of 24 rotations by right angles: the one
// with the most bone length, and the largest share of it, in tissue. A rig whose names tell head from feet is placed
// upright. Throws Error for a volume without tissue.
Armature placed_in_tissue(const LabelVolume& volume, const Armature& rig);

// Returns the result of auto_fit (core/autorig/auto_rig.h). Where none of its joints is certain and placed_in_tissue
// leaves more of the rig in the tissue, returns that rig with a warning.
AutoFit fitted_or_placed(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig,
                         Progress& progress = no_progress());

}  // namespace limber
