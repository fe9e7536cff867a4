// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/preferences.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "editor/assets.h"
#include "editor/arrangement_json.h"
#include "editor/editor.h"

namespace limber::editor {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLargestFile = 4 << 20;

// One list of what is kept, for reading and writing.
template <class Visit, class P>
void visit(P& p, const Visit& visit) {
  visit("interface", "theme", p.theme, {}, {});
  visit("interface", "scale", p.scale, 0.75, 3);
  visit("interface", "tooltip_delay", p.tooltip_delay, 0, 3);
  visit("interface", "reduce_motion", p.reduce_motion, {}, {});
  visit("interface", "keymap", p.keymap, {}, {});
  visit("interface", "advanced_steps", p.advanced_steps, {}, {});
  visit("view", "grid", p.grid, {}, {});
  visit("view", "axes", p.axes, {}, {});
  visit("view", "scale_bar", p.scale_bar, {}, {});
  visit("view", "letters", p.letters, {}, {});
  visit("view", "cross_hair", p.cross_hair, {}, {});
  visit("view", "display", p.display, {}, {});
  visit("undo", "limit_mb", p.undo_limit_mb, 64, 65536);
  visit("undo", "autosave_minutes", p.autosave_minutes, 0, 240);
  visit("jobs", "at_once", p.jobs_at_once, 1, 8);
  visit("jobs", "worker_memory_mb", p.worker_memory_mb, 0, 1 << 24);
  visit("jobs", "worker_minutes", p.worker_minutes, 0, 1 << 16);
  visit("folders", "scratch", p.scratch_folder, {}, {});
}

struct Reader {
  const Json& json;

  const Json* find(const char* group, const char* name) const {
    if (!json.contains(group) || !json[group].is_object() || !json[group].contains(name)) return nullptr;
    return &json[group][name];
  }
  void operator()(const char* group, const char* name, std::string& value, double, double) const {
    if (const Json* found = find(group, name); found && found->is_string()) value = found->get<std::string>();
  }
  void operator()(const char* group, const char* name, bool& value, double, double) const {
    if (const Json* found = find(group, name); found && found->is_boolean()) value = found->get<bool>();
  }
  void operator()(const char* group, const char* name, double& value, double low, double high) const {
    if (const Json* found = find(group, name); found && found->is_number()) value = std::clamp(found->get<double>(), low, high);
  }
  void operator()(const char* group, const char* name, int& value, double low, double high) const {
    if (const Json* found = find(group, name); found && found->is_number()) value = static_cast<int>(std::lround(std::clamp(found->get<double>(), low, high)));
  }
};

struct Writer {
  Json& json;

  template <class T>
  void operator()(const char* group, const char* name, const T& value, double, double) const {
    json[group][name] = value;
  }
};

void read_use(const Json& json, Preferences& preferences) {
  if (json.contains("recent_commands") && json["recent_commands"].is_array())
    for (const Json& id : json["recent_commands"])
      if (id.is_string() && preferences.recent_commands.size() < Preferences::kMostRecent) preferences.recent_commands.push_back(id);
  if (json.contains("command_counts") && json["command_counts"].is_object())
    for (const auto& [id, count] : json["command_counts"].items())
      if (count.is_number_integer()) preferences.command_counts[id] = std::clamp(count.get<int>(), 0, 1'000'000);
}

}  // namespace

Path preferences_path() {
  const char* config = std::getenv("XDG_CONFIG_HOME");
  const char* home = std::getenv("HOME");
  const Path base = config && *config ? Path(config) : Path(home ? home : ".") / ".config";
  return base / "limber" / "preferences.json";
}

Preferences preferences_from_json(const std::string& text, std::string& problem) {
  Preferences preferences;
  const Json json = Json::parse(sound_json(text), nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != "limber-preferences/1") {
    problem = "the file is damaged";
    return preferences;
  }
  visit(preferences, Reader{json});
  if (preferences.theme != "light") preferences.theme = "dark";
  if (preferences.display != "xray" && preferences.display != "tissue") preferences.display = "solid";
  if (json.contains("keys")) preferences.keys = key_changes_from_json(json["keys"].dump());
  if (preferences.keymap != "maya") preferences.keymap = "blender";
  read_use(json, preferences);
  if (json.contains("arrangements")) restore(json["arrangements"].dump(), preferences.arrangements);
  return preferences;
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

std::string to_json(const Preferences& preferences) {
  Json json{{"schema", "limber-preferences/1"}};
  visit(preferences, Writer{json});
  json["keys"] = Json::array();
  for (const auto& [place, keys] : preferences.keys) json["keys"].push_back({{"context", place.first}, {"operator", place.second}, {"keys", keys}});
  json["recent_commands"] = preferences.recent_commands;
  json["arrangements"] = nlohmann::json::parse(json_text(preferences.arrangements));
  json["command_counts"] = Json::object();
  for (const auto& [id, count] : preferences.command_counts) json["command_counts"][id] = count;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
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
