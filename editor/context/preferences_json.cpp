// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts preferences to JSON text and back.
#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "editor/context/layout_json.h"
#include "editor/context/preferences.h"
#include "editor/input/keymap_overrides.h"

namespace limber::editor {

namespace {

using Json = nlohmann::ordered_json;

// Calls `visit` with the group, name, value and range of each preference. Reading and writing share this list.
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
  visit("view", "fine_light", p.fine_light, {}, {});
  visit("view", "refine_at_rest", p.refine_at_rest, {}, {});
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
    if (const Json* found = find(group, name); found && found->is_number())
      value = std::clamp(found->get<double>(), low, high);
  }
  void operator()(const char* group, const char* name, int& value, double low, double high) const {
    if (const Json* found = find(group, name); found && found->is_number())
      value = static_cast<int>(std::lround(std::clamp(found->get<double>(), low, high)));
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
      if (id.is_string() && preferences.recent_commands.size() < Preferences::kMostRecent)
        preferences.recent_commands.push_back(id);
  if (json.contains("command_counts") && json["command_counts"].is_object())
    for (const auto& [id, count] : json["command_counts"].items())
      if (count.is_number_integer()) preferences.command_counts[id] = std::clamp(count.get<int>(), 0, 1'000'000);
}

}  // namespace

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

std::string to_json(const Preferences& preferences) {
  Json json{{"schema", "limber-preferences/1"}};
  visit(preferences, Writer{json});
  json["keys"] = Json::array();
  for (const auto& [place, keys] : preferences.keys)
    json["keys"].push_back({{"context", place.first}, {"operator", place.second}, {"keys", keys}});
  json["recent_commands"] = preferences.recent_commands;
  json["arrangements"] = nlohmann::json::parse(json_text(preferences.arrangements));
  json["command_counts"] = Json::object();
  for (const auto& [id, count] : preferences.command_counts) json["command_counts"][id] = count;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace limber::editor
