// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/binding/heat_diffusion.h"
#include "core/rig/armature.h"
#include "core/skin/top_four.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// Tissue that no bone has reached (pieces that lie apart in the air): each piece follows the rig bone nearest to its
// centre, and is named in the report's warnings, the largest first.
void cover_islands(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature, BestFour& best,
                   WeightsReport& report, const TissueTable* tissues = nullptr);

}  // namespace limber
