// SPDX-License-Identifier: AGPL-3.0-or-later
// What joins one sitting at the editor to the next: recent files and the like are read at the start and written a
// second after they changed and at the end; leftovers of a sitting that crashed are looked for.
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Before the first frame. With `files` to open there is no start screen.
void begin_editor_session(Editor& editor, const Folders& folders, std::vector<Path> files);
// Once a frame.
void keep_recent_files(Editor& editor);
// At the end.
void end_editor_session(Editor& editor);

}  // namespace limber::editor
