// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/keep_preferences.h"
#include "editor/context/operator_polls.h"
#include "editor/file_browser/file_browser.h"
#include "editor/screen/preferences_dialog.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

void other_theme(Editor& editor) {
  editor.preferences.theme = editor.preferences.theme == "dark" ? "light" : "dark";
  keep_preferences(editor);
}

void open_keys(Editor& editor) { editor.open_dialog(open_preferences(PreferencesPage::Keymap)); }

void browse_keymap(Editor& editor, FileRequest::Kind kind) {
  const bool save = kind == FileRequest::Kind::Save;
  browse(editor, {.purpose = "keymap",
                  .title = save ? "Export keymap" : "Import keymap",
                  .action = save ? "Export" : "Import",
                  .kind = kind,
                  .filters = {{"Keymaps", {".json"}}},
                  .name = "limber-keys.json",
                  .chosen =
                      [save](Editor& e, const Path& path) {
                        save ? export_keymap(e, path) : import_keymap(e, path);
                        open_keys(e);
                      },
                  .left = open_keys});
}

}  // namespace

std::vector<Operator> preferences_operators() {
  return {
      {"edit.preferences", "Preferences...", icon::kPreferences, "Edit",
       "Change settings: theme, scale, keys, undo, jobs and folders.",
       [](Editor& e) { e.open_dialog(open_preferences()); }},
      {"edit.keymap", "Change keys...", icon::kKeyboard, "Edit", "Change which keys run which commands.", open_keys},
      {"edit.import_keymap", "Import keymap...", icon::kImport, "Edit",
       "Load a keymap (the keys that run commands) from a file.",
       [](Editor& e) { browse_keymap(e, FileRequest::Kind::Open); }},
      {"edit.export_keymap", "Export keymap...", icon::kExport, "Edit",
       "Save the keymap (the keys that run commands) to a file, for use on another computer.",
       [](Editor& e) { browse_keymap(e, FileRequest::Kind::Save); }},
      {"edit.other_theme", "Switch theme", icon::kTheme, "Edit", "Switch between the dark and the light theme.",
       other_theme},
  };
}

}  // namespace limber::editor
