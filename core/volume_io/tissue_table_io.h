// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses the text of a label table; tissue_table.h reads and writes files.
#pragma once

#include <string>

#include "core/tissue/tissue_table.h"

namespace limber {

// Parses the text of a table. Throws an Error that names the line or key that is wrong.
//   where  the file, for messages; its name becomes the table's source
TissueTable parse_tissue_table(const std::string& bytes, const std::string& where);

}  // namespace limber
