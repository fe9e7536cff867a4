// SPDX-License-Identifier: AGPL-3.0-or-later
// What the operators of files have in common.
#pragma once

#include "editor/context/editor.h"
#include "editor/file_browser/directory_listing.h"

namespace limber::editor {

inline constexpr int kRecentOperators = 10;
// "file.recent_1" and on: one operator for each of the latest files.
void name_recent_operators(Editor& editor);

FileFilter volume_files();                   // every format that can be read
std::vector<FileFilter> writable_volumes();  // one for each format
FileFilter readable_files();                 // all that can be opened

}  // namespace limber::editor
