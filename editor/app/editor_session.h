// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps state from one run of the editor to the next. Recent files and similar settings are read at the start. They are
// written a second after a change, and at the end. The start also looks for edits left by a run that crashed.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Reads the stored state. Call before the first frame. files: files to open; if there are any, no start screen is
// shown.
void begin_editor_session(Editor& editor, const Folders& folders, std::vector<Path> files);
// Writes the stored state once it has not changed for a second. Call once per frame.
void keep_recent_files(Editor& editor);
// Writes the stored state if it changed. Call at the end.
void end_editor_session(Editor& editor);

}  // namespace limber::editor
