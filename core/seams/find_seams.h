// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the seams of a body: where different limbs touch at rest (hand and thigh, thigh and thigh, arm and chest,
// finger and finger). Tissue goes to the rig bone nearest to it through the body. Where two limbs meet that way, far
// from where they spring from each other, the surface between them is the cheapest cut through the tissue around: along
// skin where there is skin, else through connective tissue and fat in preference to muscle and organs, by the smallest
// area, and in the middle of a sheet. Both sides of the cut should be layered as free skin of the same limbs is, so
// skin that is left of only one of the two goes with the fat that it lies on (skin_layers.h). Tissue that skin shuts
// off from every bone is a bridge between two skins; it is cut in its middle. Labels that name a limb ("Muscle, arms")
// settle which one they belong to.
//
// Where limbs are grown together by nature there is no seam: along the first part of an arm, a thigh or a finger
// (kGrownTogether of the bone that it begins with). The bones' roles come from the rig's names (rig/joint_names.h); a
// rig whose names mean nothing has no seams.
#pragma once

#include "core/base/progress.h"
#include "core/bones/bone_parts.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

Seams find_seams(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                 const Armature& armature, const BoneParts& parts, Progress& progress = no_progress());

}  // namespace limber
