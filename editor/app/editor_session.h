// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps state from one run of the editor to the next. Recent files and similar settings are read at the start of the
// editor. They are written a second after a change, and at the end. At the start, edits that a crashed run left are
// also found.
#pragma once

#include "editor/app/editor.h"

namespace limber::editor {

struct Folders;

// Reads the recent files, preferences and other state that earlier runs stored. Call it before the first frame.
//   files  files to open; if there are any, the start screen is not shown
void begin_editor_session(Editor& editor, const Folders& folders, std::vector<Path> files);
// Writes the stored state a second after it has changed. Call it once per frame.
void keep_recent_files(Editor& editor);
// Writes the stored state if it has changed. Call it when the editor ends.
void end_editor_session(Editor& editor);

}  // namespace limber::editor
