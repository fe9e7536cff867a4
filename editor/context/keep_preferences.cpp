// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/keep_preferences.h"

#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"

namespace limber::editor {

namespace {

constexpr char kUnbound[] = "unbound";  // JSON member of an exported key map: the list of operators without any key

std::set<std::string> operators_of(const Keymap& keymap) {
  std::set<std::string> ids;
  for (const auto& [context, bindings] : keymap.contexts)
    for (const Binding& binding : bindings) ids.insert(binding.operator_id);
  return ids;
}

// Returns the operators that a key map file mentions: those with keys, and those in its list "unbound".
std::set<std::string> operators_known_to(const Keymap& keymap, const Path& path) {
  std::set<std::string> ids = operators_of(keymap);
  const auto json = nlohmann::json::parse(checked_json(read_file(path), path.string()), nullptr, false);
  if (const auto unbound = json.find(kUnbound); unbound != json.end() && unbound->is_array())
    for (const auto& id : *unbound)
      if (id.is_string()) ids.insert(id.get<std::string>());
  return ids;
}

}  // namespace

void export_keymap(Editor& editor, const Path& path) {
  auto json = nlohmann::ordered_json::parse(to_json(editor.keymap));
  const std::set<std::string> bound = operators_of(editor.keymap);
  json[kUnbound] = nlohmann::ordered_json::array();
  for (const std::string& id : operators_of(keymap_preset(editor.preferences.keymap)))
    if (!bound.contains(id)) json[kUnbound].push_back(id);
  write_file_atomically(path, json.dump(1) + "\n");
  editor.messages.ok("Keymap exported", path.string());
}

void import_keymap(Editor& editor, const Path& path) {
  const Keymap wanted = read_keymap(path, TwoMeanings::LetIn);
  editor.preferences.keys = differences(keymap_preset(editor.preferences.keymap), wanted);
  // An operator that the file does not mention is newer than the file. Such an operator keeps its keys.
  const std::set<std::string> known = operators_known_to(wanted, path);
  std::erase_if(editor.preferences.keys, [&](const auto& change) { return !known.contains(change.first.second); });
  keep_preferences(editor);
  const auto count = clashes(editor.keymap).size();
  if (count > 0)
    editor.messages.warn("Keymap imported",
                         std::to_string(count) + (count == 1 ? " key has" : " keys have") + " more than one command");
  else editor.messages.ok("Keymap imported", path.filename().string());
}

void apply_preferences(Editor& editor) {
  const Preferences& preferences = editor.preferences;
  editor.keymap = changed(keymap_preset(preferences.keymap), preferences.keys);
  editor.history.set_limit(std::int64_t{preferences.undo_limit_mb} << 20);
  editor.jobs.set_at_once(preferences.jobs_at_once);
  editor.touch();
}

void apply_light(Editor& editor) {
  editor.views->renderer.light_at_rest(editor.preferences.fine_light ? render::Light::Fine : render::Light::Draft);
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
