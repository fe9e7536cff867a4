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

// Assigns every voxel of bone to the rig bone that its true bone belongs to. Where truth.json lists several rig bones
// for a true bone, the voxel gets the first of them.
//   folder  where the volume lies
// Throws Error if a file is missing or on another grid, if the rig lacks a bone that the truth names, or if a voxel of
// bone has no true bone.
BoneParts true_bones(const Path& folder, const LabelVolume& volume, const TissueVoxels& tissue,
                     const TissueTable& tissues, const Armature& armature);

// Returns the true seams: the faces between two parts of the body that truth.json lists as glued, where both voxels are
// marked in glue.nrrd. None if truth.json lists no glued parts.
//   free_limbs  a rig, or nullptr. With a rig, returns also all other faces between two such parts where one of the
//               parts is a limb that is not grown together with the body (is_free() in core/seams/limbs.h)
// Throws Error if a file that is needed is missing or on another grid.
Seams true_seams(const Path& folder, const LabelVolume& volume, const Armature* free_limbs = nullptr);

}  // namespace limber::oracle
