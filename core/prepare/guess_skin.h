// SPDX-License-Identifier: AGPL-3.0-or-later
// Guesses which label is skin when the tissue table does not say so: the label that covers a body as a thin sheet.
#pragma once

#include <optional>

#include "core/tissue/tissue_table.h"

namespace limber {

struct SkinGuess {
  Label label;
  double share_of_surface;  // the label's share of the voxels that touch the air around the body
};

// Returns the label that has at least 99 % of the surface voxels and at least 40 % of its own voxels at the surface.
// Returns nothing when no label does, when `tissues` knows that label's kind, or when any label is known as skin.
std::optional<SkinGuess> guess_skin(const LabelVolume& volume, const TissueTable& tissues);

// Returns the table in which the kind of `label` is skin. The table must contain the label, which keeps its colour.
TissueTable with_skin(TissueTable table, Label label);

}  // namespace limber
