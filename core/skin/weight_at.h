// SPDX-License-Identifier: AGPL-3.0-or-later
// Interpolates the skin weights at any point of a body. The weights of those surrounding eight voxels that are tissue
// are interpolated trilinearly and reduced to four bones. A point without tissue around it gets the weights of the
// nearest tissue voxel.
#pragma once

#include <span>
#include <vector>

#include "core/skin/skin_weights.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SkinAt {
  Influence influence;
  Label label;  // label of the surrounding voxel with the largest share in the interpolation
};

// Returns the influence at each point. Throws Error when the volume has no tissue, and std::logic_error when the
// weights belong to another volume.
//   points  #P, world, mm     returns  #P
std::vector<SkinAt> skin_at(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                            std::span<const glm::dvec3> points);

}  // namespace limber
