// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the volume of small muscles and organs. An organ that lost voxels in a fold or a joint takes voxels back from
// the tissue around it, layer by layer at its surface. An organ with too many voxels gives voxels to that tissue. So
// small organs are pushed aside, not erased, where two regions of the body overlap.
//
// A soft tissue of kOrgan voxels or more whose volume has changed by more than kMostOff is brought back to a change of
// kMostOff. Only neighbouring tissues give or take voxels, and only while their own change stays below kMostOff. Bones,
// skin, air and voxels beside air are not changed, no tissue is torn, and no two connected components of a tissue are
// joined. keep_tissue_volumes() (tissue_volumes.h) reaches the exact volumes of all tissues at once, but takes longer.
#pragma once

#include <map>

#include "core/resample/neighbourhood.h"

namespace limber {

constexpr std::int64_t kOrgan = 200;  // smallest organ whose volume is corrected, in voxels at rest
constexpr double kMostOff = 0.05;     // allowed change of an organ's volume, relative to its wanted volume

// Moves borders between soft tissues until the organs have their volumes.
//   wanted   number of posed voxels that each soft tissue should have; only tissues with 200 voxels or more at rest,
//            without skin
//   soft     soft tissues, by label    skin  skin tissues, by label
//   returns  number of voxels that each organ gained (positive) or lost (negative), by label
std::map<Label, std::int64_t> keep_organ_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                                 const LabelSet& soft, const LabelSet& skin);

}  // namespace limber
