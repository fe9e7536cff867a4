// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the volume of small muscles and organs. Voxels that an organ loses in a fold or a joint are taken back from the
// tissue around it, layer by layer at its surface, and surplus voxels are given to that tissue. So where two regions of
// the body overlap, small organs are pushed aside and not erased.
//
// A soft tissue of kOrgan voxels or more whose volume is off by more than kMostOff is brought to within kMostOff. Only
// its neighbours give and take voxels, and only while they stay within the same bounds themselves. Bones, skin, air and
// voxels beside air are not changed, no tissue is torn, and no two connected components of a tissue are joined.
// Tissue_volumes.h reaches exact volumes of all tissues at once, at a higher cost.
#pragma once

#include <map>

#include "core/resample/neighbourhood.h"

namespace limber {

constexpr std::int64_t kOrgan = 200;  // smallest organ that keeps its volume, in voxels at rest
constexpr double kMostOff = 0.05;     // allowed change of an organ's volume, relative to its wanted volume

// Moves borders between soft tissues until the organs have their volumes.
//   wanted   number of posed voxels that each soft tissue should have; only tissues with 200 voxels or more at rest,
//            without skin
//   soft     soft tissues, by label    skin  skin tissues, by label
//   returns  by label, the voxels that an organ gained (positive) or lost (negative)
std::map<Label, std::int64_t> keep_organ_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                                 const LabelSet& soft, const LabelSet& skin);

}  // namespace limber
