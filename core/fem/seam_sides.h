// SPDX-License-Identifier: AGPL-3.0-or-later
// Sorts a body's tissue by the sides of seams: tissue of two bones that touch at a seam lies on two sides. The mesh of
// a solve has tets far larger than voxels, so it cannot follow the faces of a seam one by one; it is cut open between
// tissue of different sides (mesh/faces_at_seams.h).
#pragma once

#include "core/mesh/lattice_net.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"

namespace limber {

// Returns the sides of seams; all empty if no seam separates bones that move differently. A voxel lies on the side of
// the bone that it follows most. Bones with uncut tissue between them share a side, those with the most such tissue
// first, except where that would put both sides of a seam on one side. Small islands of tissue of one side, without
// bone, inside tissue of another side, belong to that other side.
//   moves_as  #bones of `weights`: index of the first bone that has the same motion
SeamSides sides_of_seams(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                         const SkinWeights& weights, const Armature& armature, const std::vector<int>& moves_as);

}  // namespace limber
