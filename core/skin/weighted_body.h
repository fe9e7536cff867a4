// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// The body that weights belong to. It holds references to the volume, tissue, tissue table and rig, which must outlive
// it.
struct WeightedBody {
  const LabelVolume& volume;
  const TissueVoxels& tissue;
  const TissueTable& tissues;
  const Armature& armature;
};

}  // namespace limber
