// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/keep_preferences.h"

#include "core/base/error.h"

namespace limber::editor {

void export_keymap(Editor& editor, const Path& path) {
  write_file_atomically(path, to_json(editor.keymap));
  editor.messages.ok("Keys exported", path.string());
}

void import_keymap(Editor& editor, const Path& path) {
  editor.preferences.keys =
      differences(keymap_preset(editor.preferences.keymap), read_keymap(path, TwoMeanings::LetIn));
  keep_preferences(editor);
  const auto count = clashes(editor.keymap).size();
  if (count > 0)
    editor.messages.warn("Keys imported",
                         std::to_string(count) + (count == 1 ? " key has" : " keys have") + " more than one command");
  else editor.messages.ok("Keys imported", path.filename().string());
}

void apply_preferences(Editor& editor) {
  const Preferences& preferences = editor.preferences;
  editor.keymap = changed(keymap_preset(preferences.keymap), preferences.keys);
  editor.history.set_limit(std::int64_t{preferences.undo_limit_mb} << 20);
  editor.jobs.set_at_once(preferences.jobs_at_once);
  editor.touch();
}

void write_preferences(Editor& editor) {
  if (editor.preferences_path.empty()) return;
  try {
    std::filesystem::create_directories(editor.preferences_path.parent_path());
    write_file_atomically(editor.preferences_path, to_json(editor.preferences));
    editor.preferences_problem = false;
  } catch (const std::exception& error) {
    if (!editor.preferences_problem) editor.messages.warn("Preferences cannot be saved", error.what());
    editor.preferences_problem = true;
  }
}

void keep_preferences(Editor& editor) {
  apply_preferences(editor);
  write_preferences(editor);
}

}  // namespace limber::editor
