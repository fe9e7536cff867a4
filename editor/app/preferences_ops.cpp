// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/preferences.h"
#include "editor/file_browser/file_browser.h"
#include "editor/screen/preferences_dialog.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

void other_theme(Context& context) {
  context.preferences->theme = context.preferences->theme == "dark" ? "light" : "dark";
  keep_preferences(context);
}

void open_keys(Context& context) { context.dialogs->open(open_preferences(PreferencesPage::Keymap)); }

void browse_keymap(Context& context, FileRequest::Kind kind) {
  const bool save = kind == FileRequest::Kind::Save;
  browse(context, {.purpose = "keymap",
                   .title = save ? "Export keymap" : "Import keymap",
                   .action = save ? "Export" : "Import",
                   .kind = kind,
                   .filters = {{"Keymaps", {".json"}}},
                   .name = "limber-keys.json",
                   .chosen =
                       [save](Context& c, const Path& path) {
                         save ? export_keymap(c, path) : import_keymap(c, path);
                         open_keys(c);
                       },
                   .left = open_keys});
}

}  // namespace

std::vector<Operator> preferences_operators() {
  return {
      {"edit.preferences", "Preferences...", icon::kPreferences, "Edit",
       "Change settings: theme, scale, keys, undo, jobs and folders.",
       [](Context& c) { c.dialogs->open(open_preferences()); }},
      {"edit.keymap", "Change keys...", icon::kKeyboard, "Edit", "Change which keys run which commands.", open_keys},
      {"edit.import_keymap", "Import keymap...", icon::kImport, "Edit",
       "Load a keymap (the keys that run commands) from a file.",
       [](Context& c) { browse_keymap(c, FileRequest::Kind::Open); }},
      {"edit.export_keymap", "Export keymap...", icon::kExport, "Edit",
       "Save the keymap (the keys that run commands) to a file, for use on another computer.",
       [](Context& c) { browse_keymap(c, FileRequest::Kind::Save); }},
      {"edit.other_theme", "Switch theme", icon::kTheme, "Edit", "Switch between the dark and the light theme.",
       other_theme},
  };
}

}  // namespace limber::editor
