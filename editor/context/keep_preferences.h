// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/platform/path.h"

namespace limber::editor {

struct Context;

// Applies changed preferences to the editor, and writes them to the file PreferencesState::path unless that is empty.
void keep_preferences(Context& context);
void apply_preferences(Context& context);
// Applies Preferences::fine_light to the pictures of the views.
void apply_light(Context& context);
// Writes the preferences to the disk without applying them. If writing fails several times in a row, only the first
// failure shows a warning.
void write_preferences(Context& context);

// Export the current key map to a file, and import a key map from a file. On import, the differences between the file
// and the preset (the program's own key map) become the user's key changes.
void export_keymap(Context& context, const Path& path);
void import_keymap(Context& context, const Path& path);

}  // namespace limber::editor
