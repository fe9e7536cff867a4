// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigid weights: every voxel follows one bone, the one nearest inside tissue (a geodesic Voronoi diagram).
#pragma once

#include "core/skin/heat_diffusion.h"

namespace limber {

SkinWeights bind_rigid(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                       Progress& progress = no_progress(), WeightsReport* report = nullptr);

}  // namespace limber
