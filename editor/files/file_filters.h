// SPDX-License-Identifier: AGPL-3.0-or-later
// File filters for dialogs, and the operators that open recent files.
#pragma once

#include "editor/file_browser/directory_listing.h"

namespace limber::editor {

struct Context;

inline constexpr int kRecentOperators = 10;
// Creates the operators "file.recent_1" and so on, one for each recent file.
void name_recent_operators(Context& context);

FileFilter volume_files();                   // one filter for all volume formats that can be read
std::vector<FileFilter> writable_volumes();  // a filter for each volume format that can be written
FileFilter readable_files();                 // one filter for all files that can be opened

}  // namespace limber::editor
