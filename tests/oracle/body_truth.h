// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the ground truth of a generated test body from the files beside its volume: truth.json, truth.nrrd (the true
// bone of each voxel of bone), parts.nrrd (arm, leg, finger ... of each voxel of tissue) and, if touching parts were
// glued together, glue.nrrd (the places where two parts must not pull each other). Only the oracle reads them, never
// the program.
#pragma once

#include "core/base/file.h"
#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_voxels.h"

namespace limber::oracle {

// Assigns every voxel of bone to the rig bone that its true bone belongs to. If several rig bones are possible, it is
// the first.
//   folder  where the volume lies
// Throws Error if a file is missing or on another grid, if the rig lacks a bone that the truth names, and if a voxel of
// bone has no true bone.
BoneParts true_bones(const Path& folder, const LabelVolume& volume, const TissueVoxels& tissue,
                     const TissueTable& tissues, const Armature& armature);

// Returns the faces between parts that were glued to each other, or none without glue.nrrd.
//   free_limbs  not nullptr: also gives the faces between parts of this rig where a limb is naturally free
//               [core/seams/limbs.h], as far as the seams that Limber finds may reach
// Throws Error if a file is missing or on another grid.
Seams true_seams(const Path& folder, const LabelVolume& volume, const Armature* free_limbs = nullptr);

}  // namespace limber::oracle
