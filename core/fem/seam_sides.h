// SPDX-License-Identifier: AGPL-3.0-or-later
// Sorts a body's tissue by the sides of seams: tissue of two bones that touch at a seam lies on two sides. The mesh of
// a solve has tets far larger than voxels, so it cannot follow the faces of a seam one by one; it is cut open between
// tissue of different sides (mesh/faces_at_seams.h).
#pragma once

#include "core/mesh/voxel_regions.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

// The sides of seams for every tissue voxel.
struct VoxelSides {
  SeamSides sides;                      // `seams` are those of the body, with their gaps closed
  std::vector<std::uint16_t> of_voxel;  // side of each tissue voxel, in brick order
  struct Stray {
    std::int64_t place;  // place of the voxel in brick order
    std::uint16_t bone;  // index in the weights
  };
  std::vector<Stray> strays;  // voxels of islands, with the bone that they must follow instead of their own
};

// Returns the sides of seams; all empty if no seam separates bones that move differently. A voxel lies on the side of
// the bone that it follows most. Bones with uncut tissue between them share a side, those with the most such tissue
// first, except where that would put both sides of a seam on one side.
//
// Seams have gaps: a hand and a thigh that touch over a large area are found to touch at most faces, not at all. Tissue
// in a gap would be drawn out from one side to the other. So uncut faces between sides are grouped, and a face stays
// uncut only if joints of the rig inside its group attach its two sides to each other, as a shoulder attaches an arm to
// the trunk.
//
// Islands are connected tissue of one side, without bone, that is not the largest of its side. They would lie loose, so
// they belong to the side around them.
//   moves_as  #bones of `weights`: index of the first bone that has the same motion
VoxelSides sides_of_seams(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                          const SkinWeights& weights, const Armature& armature, const std::vector<int>& moves_as);

// Returns a copy of the weights in which strays follow their new bone alone.
SkinWeights without_strays(SkinWeights weights, const TissueVoxels& tissue,
                           const std::vector<VoxelSides::Stray>& strays);

}  // namespace limber
