// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps tissues the connected parts (26-connected, of 50 voxels or more) that they have at rest, where posing on a grid
// tears them though the body is not torn: where a sheet or a strand is one voxel thick and the fold of a joint carries
// its voxels apart, another tissue wins the voxel between them, or a small bone comes out a few voxels smaller when it
// is turned.
//
// Bone tissues that have fewer parts than at rest are first parted (part_bones). For every tissue with more parts than
// at rest, and until it has as many again, each part, smallest first, looks for another one that comes from the same
// rest part, and takes the fewest voxels that join them: at most four, or up to 64 that all come from beside the tissue
// itself, as where a tendon thinner than a voxel is stretched over a bent knee. Of a tissue with fewer, a part that
// came out smaller than 50 voxels, but half of them or more, is filled up to 50; a part of bone tissue that came out
// with 50, but had fewer, gives what it gained. Soft tissue takes from soft tissue only, bone tissue from bone tissue.
// No voxel beside air is taken (so no skin is opened), none whose own tissue would be split by the loss, and none that
// its own part needs to stay a part.
#pragma once

#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// Rows that hold what is mended, where they are known.
struct MendRows {
  const RowSet *posed = nullptr, *rest = nullptr;
};

//   soft     tissues that are not bone
//   posed    voxels of bridges are changed
//   bone_rows  that hold bone tissue
//   returns  the number of voxels changed
std::int64_t preserve_connectivity(LabelVolume& posed, const LabelVolume& rest, const LabelSet& soft,
                                   const RestPoint& rest_point, const MendRows& rows = {},
                                   const MendRows& bone_rows = {});

// The same for rigid bones as wholes: they take soft voxels.
//   posed_bones  1 + the rig bone of each voxel of bone tissue, 0 elsewhere; what is taken is added
//   rest_bones   the same at rest        tissue  the posed tissue, on the grid of posed_bones: soft voxels may be taken
//   returns      the voxels taken
std::vector<glm::ivec3> mend_bones(LabelVolume& posed_bones, const LabelVolume& rest_bones, const LabelVolume& tissue,
                                   const LabelSet& soft, const RestPoint& rest_point, const MendRows& rows = {});

}  // namespace limber
