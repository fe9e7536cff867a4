// SPDX-License-Identifier: AGPL-3.0-or-later
// Geodesic voxel binding [Dionne & de Lasa 2013]: weights fall with the distance travelled inside tissue.
#pragma once

#include "core/skin/heat_diffusion.h"

namespace limber {

struct GeodesicBinding {
  double falloff = 0.5;  // alpha of the paper, [0, 1]: blend of sharp and smooth
};

SkinWeights bind_geodesic(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                          const GeodesicBinding& settings = {}, Progress& progress = no_progress(),
                          WeightsReport* report = nullptr);

}  // namespace limber
