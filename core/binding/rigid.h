// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes rigid weights: every voxel follows one bone, the nearest along a path inside the tissue. The result is a
// geodesic Voronoi diagram whose seeds are the voxels of each rig bone's bone tissue. (fixed_bone() in flesh_graph.h
// defines the seeds of a rig bone without bone tissue.)
#pragma once

#include "core/binding/heat_diffusion.h"

namespace limber {

SkinWeights bind_rigid(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                       const BoneParts& parts, Progress& progress = no_progress(), WeightsReport* report = nullptr,
                       const TissueTable* tissues = nullptr);

}  // namespace limber
