// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes the weights of bone tissue rigid: every bone voxel must follow one rig bone alone. Weights made by hand or by
// other programs may not be rigid. Then the bone tissue is separated into anatomical bones, each of which follows the
// rig bone that runs inside it.
#pragma once

#include "core/base/progress.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_sampler.h"

namespace limber {

// Returns weights that are rigid in bone tissue. If the given weights are rigid there, returns them unchanged.
//   is_bone  1 for each label that is bone tissue
SkinWeights with_rigid_bones(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                             const TissueTable& tissues, const LabelSet& is_bone, const Armature& armature,
                             Progress& progress = no_progress());

}  // namespace limber
