// SPDX-License-Identifier: AGPL-3.0-or-later
// Label tables of well-known volumes whose files carry no names: Bender's Visible Man arm and TotalSegmentator's
// classes. A table is offered only when it names every label that is present.
#pragma once

#include "core/tissue/tissue_table.h"

namespace limber {

// The built-in table that covers all file values of `present`, nullptr when none does. Its `source` says which it is.
const TissueTable* built_in_table_for(const TissueTable& present);

}  // namespace limber
