// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/panels/preferences.h"

namespace limber::editor {

namespace {

void other_theme(Editor& editor) {
  editor.preferences.theme = editor.preferences.theme == "dark" ? "light" : "dark";
  keep_preferences(editor);
}

}  // namespace

std::vector<Operator> preferences_operators() {
  return {
      {"edit.preferences", "Preferences...", icon::kPreferences, "Edit", "Theme, scale, keys, undo, jobs and folders.", [](Editor& e) { e.open_dialog(open_preferences()); }},
      {"edit.keymap", "Change keys...", icon::kKeyboard, "Edit", "Which keys run which commands.", [](Editor& e) { e.open_dialog(open_preferences(PreferencesPage::Keymap)); }},
      {"edit.other_theme", "Other theme", icon::kTheme, "Edit", "Changes between the dark and the light theme.", other_theme},
  };
}

}  // namespace limber::editor
