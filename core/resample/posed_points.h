// SPDX-License-Identifier: AGPL-3.0-or-later
// Where points of a body go in a pose, as resample() moves the tissue there: points in bone go with their bone, exactly
// rigid; by finite elements those in what is meshed go with their tet, those up to 10 mm beside it with the nearest
// place of its border, as far from it as at rest (voxels between skin and skin are pressed flat); all others by the
// blend of the weights around them (skin/skin_at). A point beside the body follows the nearest tissue.
#pragma once

#include <span>
#include <vector>

#include "core/deform/skinning.h"
#include "core/resample/fem_shape.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"

namespace limber {

//   shape   of a solve, or null       points  #P, world, mm, at rest       returns  #P, posed
std::vector<glm::dvec3> posed_points(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                     const SkinWeights& weights, const Armature& armature, const Pose& pose,
                                     Blend blend, const FemShape* shape, std::span<const glm::dvec3> points);

}  // namespace limber
