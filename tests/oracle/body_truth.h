// SPDX-License-Identifier: AGPL-3.0-or-later
// What is known of a body that was made to be hard, from the files beside its volume: truth.json, truth.nrrd (the true
// bone of each voxel of bone), parts.nrrd (arm, leg, finger ... of each voxel of tissue) and, where parts were glued,
// glue.nrrd (the places where two of them must not pull each other). Only the oracle reads them; Limber never does.
#pragma once

#include "core/base/file.h"
#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_voxels.h"

namespace limber::oracle {

// Every voxel of bone goes to the rig bone that its true bone belongs to: to the first, where it may follow either.
//   folder  where the volume lies
// throws Error when a file is missing or on another grid, when the rig lacks a bone that the truth names, and when a
// voxel of bone has no true bone
BoneParts true_bones(const Path& folder, const LabelVolume& volume, const TissueVoxels& tissue,
                     const TissueTable& tissues, const Armature& armature);

// The faces between two parts that were glued to each other, in the places where they were. None without glue.nrrd.
//   free_limbs  where not nullptr, of this rig: also the faces between these parts where a limb is free by nature
//               [core/seams/limbs.h], as far as the seams that Limber finds may reach
// throws Error when a file is missing or on another grid
Seams true_seams(const Path& folder, const LabelVolume& volume, const Armature* free_limbs = nullptr);

}  // namespace limber::oracle
