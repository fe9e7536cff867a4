// SPDX-License-Identifier: AGPL-3.0-or-later
// Guesses which label is bone when no tissue kind is known. A rig runs along the bones of a body, if not always inside
// them (a forearm's axis runs between two bones), and bone lies in the middle of a limb. So a label that lies close to
// the rig's bones and not further out is bone. Muscle and fat also lie further out, and a single muscle lies beside few
// of the bones.
#pragma once

#include <optional>

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

struct BoneTissueGuess {
  Label label;
  // Share of the long rig bones' length in tissue that has the label beside it, [0, 1].
  double share_of_rig;
};

// Returns the label that lies beside at least 40 % of the long rig bones' length in tissue, and is at least eight times
// as frequent there as farther out. Returns none when there is none, or when `tissues` knows the kind of any label.
std::optional<BoneTissueGuess> guess_bone_tissue(const LabelVolume& volume, const TissueTable& tissues,
                                                 const Armature& armature);

}  // namespace limber
