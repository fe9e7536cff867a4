// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the rig bone of a piece of bone that touches no other piece, from the bone voxels near it in the tissue.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

// Returns the rig bone of the nearest bone voxel that can be reached through tissue. If another bone voxel nearby has a
// rig bone that is much closer to the piece as a whole, returns that rig bone: a rib cage in one piece belongs to the
// spine in its middle, and not to the arm beside it. If no bone voxel can be reached, returns the rig bone with the
// smallest distance.
//   voxels    the piece's voxels
//   distance  mean distance from the piece's voxels to each rig bone, mm
//   bone_at   a function (index of a tissue voxel) -> its rig bone; -1: none
//   budget    upper limit on the number of voxels to visit; the number of visited voxels is subtracted
int bone_of_lonely_piece(const LabelVolume& volume, const TissueVoxels& tissue, std::vector<glm::ivec3> voxels,
                         const std::vector<float>& distance, const std::function<int(std::int64_t)>& bone_at,
                         std::int64_t& budget);

}  // namespace limber
