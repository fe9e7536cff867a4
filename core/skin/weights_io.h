// SPDX-License-Identifier: AGPL-3.0-or-later
// Weights from and to files.
//   W.nrrd   unsigned short, sizes 8 N: bone0-3 then weight0-3 per tissue voxel in brick order, keys `limber_bones`
//            (names), `limber_size`, `limber_tissue_sha256` (of the tissue masks): a mismatch with the volume is refused
//   folder   Bender's weight_NN.mha, one float volume a bone in the rig's order
//   .mha     Bender's hard skin map: one bone number (from 1, in the rig's order; 0 air) per voxel
#pragma once

#include "core/base/file.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct WeightsFile {
  SkinWeights weights;
  std::vector<std::string> warnings;
};

// Throws Error when the file does not belong to this tissue or names a bone the rig lacks.
WeightsFile read_weights(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature);
void write_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& path);
void write_bender_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                          const Path& folder);

}  // namespace limber
