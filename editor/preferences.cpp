// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/preferences.h"

#include <cstdlib>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "editor/assets.h"
#include "editor/editor.h"

namespace limber::editor {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLargestFile = 4 << 20;

}  // namespace

Path preferences_path() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  const Path base = config && *config ? Path(config) : Path(home ? home : ".") / ".config";
  return base / "limber" / "preferences.json";
}

Preferences read_preferences(const Path& path, std::string& problem) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  Preferences preferences;
  try {
    preferences = preferences_from_json(read_file(path, kLargestFile), problem);
  } catch (const Error& error) {
    problem = error.what();
    return {};
  }
  if (problem.empty()) return preferences;
  // Out of the way of the next start, and not lost.
  const Path aside = path.string() + ".damaged";
  std::filesystem::rename(path, aside, ignored);
  problem = Error(problem, path.string(), "the program's own are used; the old file is kept as " + aside.filename().string()).what();
  return preferences;
}

Keymap keymap_preset(const std::string& name) {
  const Keymap blender = read_keymap(asset("keymap.json"));
  if (name != "maya") return blender;
  const Json json = Json::parse(read_file(asset("keymap_maya.json")), nullptr, false);
  return changed(blender, key_changes_from_json(json.at("keys").dump()));
}

void export_keymap(Editor& editor, const Path& path) {
  write_file_atomically(path, to_json(editor.keymap));
  editor.messages.ok("Keys exported", path.string());
}

void import_keymap(Editor& editor, const Path& path) {
  editor.preferences.keys = differences(keymap_preset(editor.preferences.keymap), read_keymap(path, TwoMeanings::LetIn));
  keep_preferences(editor);
  const auto count = clashes(editor.keymap).size();
  if (count > 0) editor.messages.warn("Keys imported", std::to_string(count) + (count == 1 ? " key has" : " keys have") + " two meanings");
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
    if (!editor.preferences_problem) editor.messages.warn("Preferences are not kept", error.what());
    editor.preferences_problem = true;
  }
}

void keep_preferences(Editor& editor) {
  apply_preferences(editor);
  write_preferences(editor);
}

}  // namespace limber::editor
