// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the seams of a body: the voxel faces at which different limbs touch at rest (hand and thigh, thigh and thigh,
// arm and chest, finger and finger). Each tissue voxel is assigned to the rig bone nearest to it through tissue. Where
// two limbs touch, the surface between them is the cheapest cut through the tissue around. The cut is cheap along skin,
// then through connective tissue, then through fat, and expensive through muscle and organs. Of cuts through the same
// tissue, one with a small area and in the middle of a sheet is cheapest. On both sides of the cut, fat and muscle
// should lie as deep below the cut as they lie below the skin where these limbs border on air. So if there is only one
// layer of skin between two limbs, it goes to the limb on whose fat it lies (skin_layers.h). Tissue from which no bone
// can be reached without crossing skin lies between the skins of two limbs; it is cut in its middle. A label that names
// a limb ("Muscle, arms") decides to which limb its tissue belongs.
//
// There is no seam where a limb naturally is one with the body: along the first part of an arm, a thigh or a finger
// (the share Limb::grown_together of its first bone). The limbs are found by the names of the rig's bones
// (rig/joint_names.h); a rig whose names are not recognized has no seams.
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
