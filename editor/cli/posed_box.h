// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the bounding box of a posed body.
#pragma once

#include <array>
#include <vector>

#include "core/deform/skinning.h"
#include "core/skin/skin_weights.h"

namespace limber::editor {

// Returns the bounding box of the posed tissue in voxels of `grid`. The box is computed from bones and weights alone,
// so that pictures of a preview and of a resampled volume show the same part of space.
std::array<glm::dvec3, 2> box_of_posed(const Grid& rest_grid, const Grid& grid, const TissueVoxels& tissue,
                                       const SkinWeights& weights, const std::vector<RigidTransform>& posed_from_rest,
                                       Blend blend);

}  // namespace limber::editor
