// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Applies changed preferences to the editor, and writes them to the file Editor::preferences_path unless that is empty.
void keep_preferences(Editor& editor);
void apply_preferences(Editor& editor);
// Applies Preferences::fine_light to the pictures of the views.
void apply_light(Editor& editor);
// Writes the preferences to the disk without applying them. If writing fails several times in a row, only the first
// failure shows a warning.
void write_preferences(Editor& editor);

// Export the current key map to a file, and import a key map from a file. On import, the differences between the file
// and the preset (the program's own key map) become the user's key changes.
void export_keymap(Editor& editor, const Path& path);
void import_keymap(Editor& editor, const Path& path);

}  // namespace limber::editor
