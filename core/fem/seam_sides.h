// SPDX-License-Identifier: AGPL-3.0-or-later
// Sorts the bones of a rig by the sides of seams: tissue of two bones that touch at a seam lies on two sides. The mesh
// of a solve has tets far larger than voxels, so it cannot follow the faces of a seam one by one; it is cut open
// between tissue of different sides (mesh/lattice_net.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Returns the side of each bone, from 0; empty if no seam separates bones that move differently. A voxel lies on the
// side of the bone that it follows most. Bones with uncut tissue between them share a side, those with the most such
// tissue first, except where that would put both sides of a seam on one side.
//   moves_as  #bones: index of the first bone that has the same motion
std::vector<std::uint16_t> sides_of_seams(const TissueVoxels& tissue, const SkinWeights& weights,
                                          const std::vector<int>& moves_as);

}  // namespace limber
