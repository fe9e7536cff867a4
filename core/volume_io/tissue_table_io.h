// SPDX-License-Identifier: AGPL-3.0-or-later
// The text of a label table, without its file; see tissue_table.h for reading and writing files.
#pragma once

#include <string>

#include "core/tissue/tissue_table.h"

namespace limber {

//   where  the file, for messages; its name becomes the table's source          throws Error naming the line or key
TissueTable parse_tissue_table(const std::string& bytes, const std::string& where);

}  // namespace limber
