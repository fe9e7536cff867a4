// SPDX-License-Identifier: AGPL-3.0-or-later
// Separates connected components of bone tissue that are separate at rest. The wall between two marrow cavities, or
// between spongy regions of a bone, is often one voxel thick. When a bone is rotated on the grid, such a wall gets
// holes of single voxels. Where a rig moves one bone into another, the marrows of the two bones touch. Then a label has
// fewer components than at rest, though no bone has fused.
//
// A bone tissue is changed if it has fewer components (26-connected, of 50 voxels or more) than at rest. If one of its
// voxels touches a voxel that comes from another component at rest, the voxel is given to another bone tissue: the one
// that most of its neighbours have, which is the tissue of the wall. The larger of two touching components gives voxels
// first. A voxel is not given if its own component would come apart there, or if it would join two components of the
// other tissue.
#pragma once

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// Separates the fused components of all bone tissues.
//   soft     tissues that are not bone, by label: they neither give nor take voxels
//   returns  the number of changed voxels of `posed`
std::int64_t part_bones(LabelEdit posed, const Components& of_posed, const LabelView& rest, const Components& of_rest,
                        const LabelSet& soft, const RestPoint& rest_point);

}  // namespace limber
