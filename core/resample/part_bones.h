// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps pieces of bone tissue apart that were apart at rest. The wall between two marrows, or between a bone's spongy
// pieces, is often one voxel thick; turned on the grid it gets pinholes, and where a rig drives bone into bone the
// marrows of both meet. Then a label has fewer connected parts than at rest, though no bone has fused.
//
// For every bone tissue with fewer parts (26-connected, of 50 voxels or more) than at rest, voxels that touch a voxel
// from another rest part are given to the bone tissue that most of their neighbours have, which is that wall's. The
// larger of two parts gives. A voxel is not given when its own part would come apart there, or when it would join two
// other parts.
#pragma once

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

//   soft     the other tissues: they neither give nor take
//   returns  the number of voxels of `posed` changed
std::int64_t part_bones(LabelVolume& posed, const Components& of_posed, const LabelVolume& rest,
                        const Components& of_rest, const LabelSet& soft, const RestPoint& rest_point);

}  // namespace limber
