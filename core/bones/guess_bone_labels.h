// SPDX-License-Identifier: AGPL-3.0-or-later
// Guesses which label is bone if no tissue kind is known. A rig runs along the bones of a body, though not always
// inside them (a forearm's axis runs between two bones), and bone is in the middle of a limb. So a label that is found
// close to the rig's bones and not farther out is bone. Muscle and fat are also found farther out, and a single muscle
// is beside only a few of the bones.
#pragma once

#include <optional>

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct BoneTissueGuess {
  Label label;
  // Share of the length of the long rig bones, where they are in tissue, beside which the label is found, [0, 1].
  double share_of_rig;
};

// Returns the label that is beside at least 40 % of the length of long rig bones in tissue, and is at least eight times
// as frequent beside these bones as farther out. Returns none if no label meets both limits, or if `tissues` contains
// the kind of any label.
std::optional<BoneTissueGuess> guess_bone_tissue(const LabelVolume& volume, const TissueTable& tissues,
                                                 const Armature& armature);

}  // namespace limber
