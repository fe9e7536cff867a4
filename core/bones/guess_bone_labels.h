// SPDX-License-Identifier: AGPL-3.0-or-later
// Which label is bone when nothing says so. A skeleton runs along its bones, if not always inside them (a forearm's
// axis runs between two), and bone lies in the middle of a limb: a label that accompanies the rig's bones closely and
// is missing around them is bone. Muscle and fat are found around as well, and a single muscle lies beside few of the
// bones.
#pragma once

#include <optional>

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct BoneTissueGuess {
  Label label;
  double share_of_rig;  // of the long bones' length in tissue, that has the label beside it
};

// The label that lies beside at least 40 % of the long bones' length in tissue, and is at least eight times as frequent
// there as farther out. Nothing when there is none, or when `tissues` knows what any of the labels is.
std::optional<BoneTissueGuess> guess_bone_tissue(const LabelVolume& volume, const TissueTable& tissues,
                                                 const Armature& armature);

}  // namespace limber
