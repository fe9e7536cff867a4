// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the volume of every tissue of a bone that is turned. A rigid motion changes no volume, but labels read on a
// turned grid do: a layer of one voxel, as spongy bone often is, loses up to a twentieth of its voxels to the thicker
// layers beside it.
//
// Each tissue of a rig bone gets a price that is added to its membership (label_sampler.h), and every voxel goes to the
// tissue whose sum is largest. Prices are such that each tissue has its share of the bone's voxels at rest [Jacobs,
// Merkurjev & Esedoglu, Auction dynamics: a volume constrained MBO scheme, J. Comput. Phys. 2018]. So those voxels
// change hands that lie nearest to a border, and where the grid has kept the volumes none does.
#pragma once

#include "core/resample/preserve_connectivity.h"

namespace limber {

//   posed        its bones as read at `rest_point`; voxels of bone tissue are changed to another of the same bone
//   posed_bones  1 + the rig bone of each voxel of bone tissue, 0 elsewhere
//   rest_bones   the same at rest        soft  tissues that are not bone
//   returns      the number of voxels changed
std::int64_t keep_bone_volumes(LabelVolume& posed, const LabelVolume& posed_bones, const LabelVolume& rest,
                               const LabelVolume& rest_bones, const LabelSet& soft, const RestPoint& rest_point,
                               const MendRows& rows = {});

}  // namespace limber
