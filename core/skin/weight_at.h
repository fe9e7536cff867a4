// SPDX-License-Identifier: AGPL-3.0-or-later
// What any point of a body follows: the mean of the influences of the tissue voxels around it, weighted by how near
// they are (trilinear over the eight voxels whose centres surround it), rounded to four bones. A point that no tissue
// surrounds follows the nearest tissue voxel.
#pragma once

#include <span>
#include <vector>

#include "core/skin/skin_weights.h"
#include "core/volume/label_volume.h"

namespace limber {

struct SkinAt {
  Influence influence;
  Label label;  // of the voxel that counts most
};

//   points  #P, world, mm     returns  #P
// Throws Error when the volume has no tissue; std::logic_error when the weights are another volume's.
std::vector<SkinAt> skin_at(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                            std::span<const glm::dvec3> points);

}  // namespace limber
