// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Applies changed preferences to the editor, and writes them to the file Editor::preferences_path unless that is empty.
void keep_preferences(Editor& editor);
void apply_preferences(Editor& editor);
// Writes the preferences to the disk without applying them. Of several failures in a row, only the first shows a
// warning.
void write_preferences(Editor& editor);

// Export the current key map to a file, and import a key map file. On import, the file's differences from the preset
// become the user's key changes.
void export_keymap(Editor& editor, const Path& path);
void import_keymap(Editor& editor, const Path& path);

}  // namespace limber::editor
