// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/binding/heat_settings.h"
#include "core/rig/armature.h"
#include "core/skin/top_four.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

// Gives weights to connected components of tissue that no bone has reached because air surrounds them. Each component
// follows the rig bone nearest to its centre. The report's warnings name the largest components first.
void cover_islands(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature, BestFour& best,
                   WeightsReport& report, const TissueTable* tissues = nullptr);

}  // namespace limber
