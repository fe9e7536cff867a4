// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigs of any make, other units, other axes, in a volume they were not made for: Bender's, a BVH file's joints.
#pragma once

#include "core/autorig/auto_rig.h"
#include "core/base/progress.h"

namespace limber {

// The rig as large as the tissue and in its middle, in the one of 24 turns by right angles in which it suits best: most
// of its bones' length in tissue, and the greater share of it. One whose names tell head from feet stands upright.
// Throws Error for a volume without tissue.
Armature placed_in_tissue(const LabelVolume& volume, const Armature& rig);

// auto_fit (core/autorig/auto_rig.h); where no joint of that is sure and placing alone leaves more of the rig in the
// tissue, the rig as it is placed, with a warning.
AutoFit fitted_or_placed(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig,
                         Progress& progress = no_progress());

}  // namespace limber
