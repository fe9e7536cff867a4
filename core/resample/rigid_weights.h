// SPDX-License-Identifier: AGPL-3.0-or-later
// Bone tissue must follow one rig bone wholly. Weights made by hand or by other programs may not: then the bones of the
// volume are separated, and each follows the rig bone it hugs.
#pragma once

#include "core/base/progress.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_sampler.h"

namespace limber {

//   is_bone  per label        returns  the weights themselves where their bone tissue is rigid already
SkinWeights with_rigid_bones(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                             const TissueTable& tissues, const LabelSet& is_bone, const Armature& armature,
                             Progress& progress = no_progress());

}  // namespace limber
