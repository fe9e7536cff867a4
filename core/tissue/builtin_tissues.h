// SPDX-License-Identifier: AGPL-3.0-or-later
// Provides label tables for well-known volumes whose files contain no names: Bender's Visible Man arm and
// TotalSegmentator's classes. A table is used only when it names every label in the volume.
#pragma once

#include "core/tissue/tissue_table.h"

namespace limber {

// Returns the built-in table that names every file value in `present`, or nullptr when there is none. The member
// `source` of the result is the table's name.
const TissueTable* built_in_table_for(const TissueTable& present);

}  // namespace limber
