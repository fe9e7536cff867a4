// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes weights by heat diffusion through the tissue [after Baran & Popovic 2007, in the volume]. For each rig bone,
// its bone tissue has the fixed temperature 1, and the tissue of all other bones 0. Heat flows through soft tissue
// (never through air) with a conductivity that depends on the kind of tissue. The steady temperatures are the weights.
// Soft tissue also receives heat from the bone that is nearest along a path through the tissue. This keeps the blend at
// a joint as wide as the limb is thick. (flesh_graph.h defines how strong this heat is, and which bone gives it near a
// joint or a collarbone.) A rig bone without bone tissue fixes the temperature of the flesh around its axis.
//
// In very large volumes (HeatDiffusion::most_cells), temperatures are computed for cells of several voxels
// (heat_cells.h) and interpolated to voxels (cell_interpolation.h). In the gaps between bones, cells are too coarse:
// there every voxel is solved for (joint_heat.h).
#pragma once

#include "core/base/progress.h"
#include "core/binding/heat_settings.h"
#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"

namespace limber {

// Computes the skin weights of a volume. Throws Error if the residual of a solve stays above that of the
// settings.
SkinWeights diffuse_heat(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                         const HeatDiffusion& settings = {}, Progress& progress = no_progress(),
                         WeightsReport* report = nullptr);
// Computes the skin weights of a volume whose bone tissue is already split into parts, one rig bone for each part.
SkinWeights diffuse_heat(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const Armature& armature, const BoneParts& parts, const HeatDiffusion& settings = {},
                         Progress& progress = no_progress(), WeightsReport* report = nullptr);

}  // namespace limber
