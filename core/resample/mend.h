// SPDX-License-Identifier: AGPL-3.0-or-later
// Rejoins soft tissue that posing has torn. Where a sheet or a strand is one voxel thick and the fold of a joint carries
// its voxels apart, or another tissue wins the voxel between them, a piece comes off: the tissue has one connected part
// more than at rest, though the body has not.
//
// For every tissue with more parts (26-connected, of 50 voxels or more) than at rest, and until it has as many again,
// each part, smallest first, looks for another one that comes from the same rest part, and takes the fewest voxels that
// join them, at most four. A bridge goes through soft tissue only. It never takes a voxel beside air (so no skin is
// opened), one whose own tissue would be split by the loss, or one that its own part needs to stay a part.
#pragma once

#include <functional>
#include <vector>

#include "core/volume/label_sampler.h"

namespace limber {

constexpr std::int64_t kSmallestPart = 50;  // voxels; what is smaller comes and goes with the grid

// The rest point that a tissue voxel of the posed volume is the image of; both in voxel coordinates.
using RestPoint = std::function<glm::dvec3(const glm::ivec3& posed_voxel)>;

//   soft     tissues that may be mended and may give voxels
//   posed    voxels of bridges are changed
//   returns  the number of voxels changed
std::int64_t mend(LabelVolume& posed, const LabelVolume& rest, const LabelSet& soft, const RestPoint& rest_point);

// The same for rigid bones, whose thin places can come apart when they are turned on the grid.
//   posed_bones  1 + the rig bone of each voxel of bone tissue, 0 elsewhere; bridges are added
//   rest_bones   the same at rest        tissue  the posed tissue, on the grid of posed_bones: soft voxels may be taken
//   returns      the voxels of the bridges
std::vector<glm::ivec3> mend_bones(LabelVolume& posed_bones, const LabelVolume& rest_bones, const LabelVolume& tissue,
                                   const LabelSet& soft, const RestPoint& rest_point);

}  // namespace limber
