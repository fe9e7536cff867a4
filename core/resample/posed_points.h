// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves points of a body to a pose, each point as resample() moves the tissue around it. Points in bone move rigidly
// with their bone. With finite elements, points inside the mesh move with their tet. Points up to 10 mm outside the
// mesh move with the nearest point of its border and keep their distance from the border. All other points are skinned
// by the weights around them (skin/weight_at.h). A point outside the body follows the nearest tissue.
#pragma once

#include <span>
#include <vector>

#include "core/deform/skinning.h"
#include "core/resample/baked_pose.h"
#include "core/resample/fem_shape.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"

namespace limber {

// Returns the posed positions of points.
//   shape   a solved shape, or null       points  #P, world, mm, at rest       returns  #P, world, mm
std::vector<glm::dvec3> posed_points(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                     const SkinWeights& weights, const Armature& armature, const Pose& pose,
                                     Blend blend, const FemShape* shape, std::span<const glm::dvec3> points,
                                     const BakedJoints& baked = {});

}  // namespace limber
