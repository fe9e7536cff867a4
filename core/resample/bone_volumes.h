// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the volume of every tissue of a rotated bone. A rigid motion changes no volume, but reading labels on a rotated
// grid does: a tissue that is one voxel thick, as spongy bone often is, loses up to 5 % of its voxels to thicker
// tissues beside it.
//
// At each voxel every tissue has a membership, the interpolated share of its label there (label_sampler.h). Each tissue
// of a rig bone gets a price, a number that is added to its memberships, and a voxel goes to the tissue with the
// largest sum. The prices are chosen so that each tissue keeps the share of the bone's voxels that it has at rest
// [Jacobs, Merkurjev & Esedoglu, Auction dynamics: a volume constrained MBO scheme, J. Comput. Phys. 2018]. So only
// voxels near a border change their tissue, and none changes in a bone whose volumes are right.
#pragma once

#include "core/resample/preserve_connectivity.h"

namespace limber {

// Moves voxels of bone tissue to another tissue of the same rig bone until the volumes are as at rest.
//   posed        posed labels; those of bone voxels are changed
//   posed_bones  1 + the rig bone of each posed voxel of bone tissue, 0 elsewhere
//   rest_bones   1 + the rig bone of each voxel of bone tissue at rest, 0 elsewhere
//   soft         tissues that are not bone, by label
//   returns      the number of changed voxels
std::int64_t keep_bone_volumes(LabelEdit posed, const LabelView& posed_bones, const LabelVolume& rest,
                               const LabelView& rest_bones, const LabelSet& soft, const RestPoint& rest_point,
                               const MendRows& rows = {});

}  // namespace limber
