// SPDX-License-Identifier: AGPL-3.0-or-later
// Guesses which label is skin if the tissue table does not say so. It is the label that covers the body as a thin
// sheet.
#pragma once

#include <optional>

#include "core/tissue/tissue_table.h"

namespace limber {

struct SkinGuess {
  Label label;
  double share_of_surface;  // the label's share of the voxels that touch the air around the body
};

// Returns the label that covers at least 99 % of the body's surface voxels and has at least 40 % of its own voxels at
// the surface. Returns nothing if there is no such label, if its kind in `tissues` is known, or if `tissues` already
// has a skin.
std::optional<SkinGuess> guess_skin(const LabelVolume& volume, const TissueTable& tissues);

// Returns the table with the kind of `label` set to skin, and with the material of skin. The label must be in the
// table, and keeps its colour.
TissueTable with_skin(TissueTable table, Label label);

}  // namespace limber
