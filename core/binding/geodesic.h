// SPDX-License-Identifier: AGPL-3.0-or-later
// Geodesic voxel binding [Dionne & de Lasa 2013]: a bone's weight depends on the length d of the shortest path to the
// bone inside the tissue, as (1 / ((1 - falloff) d + falloff d^2))^2 with d in units of 100 mm. Bone tissue stays
// exactly rigid. The ratio of a bone's weight to that of the nearest bone is raised to the power of the tissue's
// stiffness.
#pragma once

#include "core/binding/heat_diffusion.h"

namespace limber {

struct GeodesicBinding {
  double falloff = 0.5;  // the falloff in the formula above, [0, 1]; 1 gives the sharpest blends
  BlendStiffness stiffness;
};

SkinWeights bind_geodesic(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                          const BoneParts& parts, const GeodesicBinding& settings = {},
                          Progress& progress = no_progress(), WeightsReport* report = nullptr,
                          const TissueTable* tissues = nullptr);

}  // namespace limber
