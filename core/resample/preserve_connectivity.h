// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the number of connected components (26-connected, of 50 voxels or more) that each tissue has at rest. Posing on
// a grid tears tissues of a body that is not torn: the fold of a joint carries the voxels of a thin sheet or strand
// apart, another tissue wins the voxel between them, or a rotated small bone comes out a few voxels smaller.
//
// First, bone tissues with fewer components than at rest are separated (part_bones). Then the components of every
// tissue with too many of them are joined until their number is right. Each component, smallest first, is connected to
// another one from the same rest component by the fewest voxels. Such a bridge has at most four voxels, or up to 64
// that all come from beside the tissue at rest, as where a tendon thinner than a voxel is stretched over a bent knee.
//
// In a tissue with too few components, a component of 25 to 49 voxels is filled up to 50. A component of bone tissue
// with 50 voxels or more that has fewer at rest gives the gained voxels back. Soft tissue takes voxels from soft tissue
// only, bone tissue from bone tissue only. Three kinds of voxels are never taken: those beside air (so no skin is
// opened), those whose loss would split their own tissue, and those whose loss would bring their own component below 50
// voxels.
#pragma once

#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// The rows of the posed and of the rest volume that hold the tissue to repair; nullptr: all rows.
struct MendRows {
  const RowSet *posed = nullptr, *rest = nullptr;
};

// Restores the number of connected components of every tissue in `posed`.
//   soft       tissues that are not bone, by label
//   rows       rows that hold tissue        bone_rows  rows that hold bone tissue
//   returns    the number of changed voxels
std::int64_t preserve_connectivity(LabelVolume& posed, const LabelVolume& rest, const LabelSet& soft,
                                   const RestPoint& rest_point, const MendRows& rows = {},
                                   const MendRows& bone_rows = {});

// Restores the number of connected components of every rig bone as a whole; bones take voxels of soft tissue.
//   posed_bones  1 + the rig bone of each voxel of bone tissue, 0 elsewhere; taken voxels are added
//   rest_bones   like posed_bones, for the rest volume
//   tissue       the posed tissue on the grid of posed_bones; its soft voxels may be taken
//   returns      the taken voxels
std::vector<glm::ivec3> mend_bones(LabelVolume& posed_bones, const LabelVolume& rest_bones, const LabelVolume& tissue,
                                   const LabelSet& soft, const RestPoint& rest_point, const MendRows& rows = {});

}  // namespace limber
