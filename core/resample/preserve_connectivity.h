// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the number of connected components (26-connected, of 50 voxels or more) that each tissue has at rest. A posed
// voxel volume may look torn though the body is not: in the fold of a joint the voxels of a thin sheet or strand move
// apart and another tissue gets the voxel between them, or a small bone loses a few voxels by a rotation.
//
// First, components of bone tissues that have fused are separated (part_bones.h). Then, in every tissue with too many
// components, components are joined until their number is as at rest. Each component, smallest first, is joined to
// another one that comes from the same component at rest, by a bridge with as few voxels as possible. A bridge has at
// most four voxels. It may have up to 64 if all of them come from positions inside or beside the tissue at rest, for
// example where a tendon thinner than a voxel is stretched over a bent knee.
//
// In a tissue with too few components, a component of 25 to 49 voxels is filled up to 50. A component of bone tissue
// that has 50 voxels or more, but fewer at rest, gives the additional voxels back. Soft tissue takes voxels from soft
// tissue only, bone tissue from bone tissue only. Three kinds of voxels are never taken: those beside air (so no skin
// is opened), those whose loss would split their own tissue, and those whose loss would bring their own component below
// 50 voxels.
#pragma once

#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// The rows (along x) of the posed volume, and those of the rest volume, that contain the tissue to repair; nullptr: all
// rows. Other rows are skipped to save time.
struct MendRows {
  const RowSet *posed = nullptr, *rest = nullptr;
};

// Restores the number of connected components of every tissue in `posed`.
//   soft       tissues that are not bone, by label
//   rows       rows that contain tissue     bone_rows  rows that contain bone tissue
//   returns    the number of changed voxels
std::int64_t preserve_connectivity(LabelEdit posed, const LabelView& rest, const LabelSet& soft,
                                   const RestPoint& rest_point, const MendRows& rows = {},
                                   const MendRows& bone_rows = {});

// Restores the number of connected components of every rig bone, whatever the tissues in it. Bones take voxels of soft
// tissue.
//   posed_bones  1 + the rig bone of each posed voxel of bone tissue, 0 elsewhere; taken voxels are added
//   rest_bones   1 + the rig bone of each voxel of bone tissue at rest, 0 elsewhere
//   tissue       the posed tissue on the grid of posed_bones; its soft voxels may be taken
//   returns      the taken voxels
std::vector<glm::ivec3> mend_bones(LabelEdit posed_bones, const LabelView& rest_bones, const LabelView& tissue,
                                   const LabelSet& soft, const RestPoint& rest_point, const MendRows& rows = {});

}  // namespace limber
