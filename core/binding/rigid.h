// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigid weights: every voxel follows one bone, the one nearest to it on ways inside the tissue (a geodesic Voronoi
// diagram of the bones' own voxels; see flesh_graph.h for bones without any).
#pragma once

#include "core/binding/heat_diffusion.h"

namespace limber {

SkinWeights bind_rigid(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                       const BoneParts& parts, Progress& progress = no_progress(), WeightsReport* report = nullptr);

}  // namespace limber
