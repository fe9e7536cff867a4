// SPDX-License-Identifier: AGPL-3.0-or-later
// Which label is bone when nothing says so: a skeleton runs through bone, and bone is a small part of a body.
#pragma once

#include <optional>

#include "core/rig/armature.h"
#include "core/volume/tissue_table.h"

namespace limber {

struct BoneTissueGuess {
  Label label;
  double share_of_rig;  // of the rig's length in tissue that runs through the label
};

// The label through which at least 60 % of the rig's length in tissue runs, if that is at least four times its share of all
// tissue. Nothing when there is none, or when `tissues` knows what any of the labels is.
std::optional<BoneTissueGuess> guess_bone_tissue(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature);

}  // namespace limber
