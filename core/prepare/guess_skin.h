// SPDX-License-Identifier: AGPL-3.0-or-later
// Which label is skin when nothing says so: the one that covers a body as a thin sheet.
#pragma once

#include <optional>

#include "core/tissue/tissue_table.h"

namespace limber {

struct SkinGuess {
  Label label;
  double share_of_surface;  // of the voxels that have a face at the air around the body
};

// The label of at least 99 % of the surface, of whose own voxels at least 40 % lie there. Nothing when there is none,
// when `tissues` knows what it is, or knows another label as skin.
std::optional<SkinGuess> guess_skin(const LabelVolume& volume, const TissueTable& tissues);

// The same table with that label as skin, in the colour it has. The label is of the table.
TissueTable with_skin(TissueTable table, Label label);

}  // namespace limber
