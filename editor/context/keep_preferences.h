// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// After a change: acts on the editor at once, and is written to Editor::preferences_path unless that is empty.
void keep_preferences(Editor& editor);
void apply_preferences(Editor& editor);
// Only into the file; a failure becomes a warning, once.
void write_preferences(Editor& editor);

// The keys of the moment as a key map; and such a file in their place, kept as changes of the preset.
void export_keymap(Editor& editor, const Path& path);
void import_keymap(Editor& editor, const Path& path);

}  // namespace limber::editor
