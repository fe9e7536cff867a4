// SPDX-License-Identifier: AGPL-3.0-or-later
// What a fold or a joint takes from a small muscle or organ comes back from what lies around it, layer by layer at its
// surface, and what it gained beyond its own goes there: where two places of the body claim a voxel, small ones are
// pushed aside, not erased.
//
// A soft tissue of kOrgan voxels or more that is off its volume by more than kMostOff gets it to within that. Only its
// neighbours give and take, and only while they themselves stay within the same bounds. Bones, skin, air and what lies
// at air are left alone; no tissue is torn, and no two of its parts are joined. Tissue_volumes.h does the same exactly,
// for all tissues at once, at a price.
#pragma once

#include <map>

#include "core/resample/neighbourhood.h"

namespace limber {

constexpr std::int64_t kOrgan = 200;  // voxels at rest
constexpr double kMostOff = 0.05;

//   wanted   voxels by soft tissue, skin aside, that is 200 or more at rest: its own volume on the posed grid
//   soft     soft tissues, by label    skin  by label
//   returns  by label of an organ, the voxels that it was given (positive) or had to give
std::map<Label, std::int64_t> keep_organ_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                                 const LabelSet& soft, const LabelSet& skin);

}  // namespace limber
