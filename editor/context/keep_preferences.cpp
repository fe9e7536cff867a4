// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/keep_preferences.h"

#include <set>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/project/job.h"
#include "editor/context/context.h"
#include "editor/context/preferences.h"
#include "editor/context/preferences_state.h"
#include "editor/context/views.h"
#include "editor/input/keymap_overrides.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr char kUnbound[] = "unbound";  // JSON member of an exported key map: the list of operators without any key

std::set<std::string> operators_of(const Keymap& keymap) {
  std::set<std::string> ids;
  for (const auto& [key_context, bindings] : keymap.contexts)
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

void export_keymap(Context& context, const Path& path) {
  auto json = nlohmann::ordered_json::parse(to_json(context.keymap));
  const std::set<std::string> bound = operators_of(context.keymap);
  json[kUnbound] = nlohmann::ordered_json::array();
  for (const std::string& id : operators_of(keymap_preset(context.preferences->keymap)))
    if (!bound.contains(id)) json[kUnbound].push_back(id);
  write_file_atomically(path, json.dump(1) + "\n");
  context.messages->ok("Keymap exported", path.string());
}

void import_keymap(Context& context, const Path& path) {
  const Keymap wanted = read_keymap(path, TwoMeanings::LetIn);
  context.preferences->keys = differences(keymap_preset(context.preferences->keymap), wanted);
  // An operator that the file does not mention is newer than the file. Such an operator keeps its keys.
  const std::set<std::string> known = operators_known_to(wanted, path);
  std::erase_if(context.preferences->keys, [&](const auto& change) { return !known.contains(change.first.second); });
  keep_preferences(context);
  const auto count = clashes(context.keymap).size();
  if (count > 0)
    context.messages->warn("Keymap imported",
                           std::to_string(count) + (count == 1 ? " key has" : " keys have") + " more than one command");
  else context.messages->ok("Keymap imported", path.filename().string());
}

void apply_preferences(Context& context) {
  const Preferences& preferences = context.preferences;
  *context.keymap = changed(keymap_preset(preferences.keymap), preferences.keys);
  context.history->set_limit(std::int64_t{preferences.undo_limit_mb} << 20);
  context.jobs->set_at_once(preferences.jobs_at_once);
  context.ui->touch();
}

void apply_light(Context& context) {
  context.views->renderer.light_at_rest(context.preferences->fine_light ? render::Light::Fine : render::Light::Draft);
}

void write_preferences(Context& context) {
  if (context.preferences_state->path.empty()) return;
  try {
    std::filesystem::create_directories(context.preferences_state->path.parent_path());
    write_file_atomically(context.preferences_state->path, to_json(context.preferences));
    context.preferences_state->problem = false;
  } catch (const std::exception& error) {
    if (!context.preferences_state->problem) context.messages->warn("Preferences cannot be saved", error.what());
    context.preferences_state->problem = true;
  }
}

void keep_preferences(Context& context) {
  apply_preferences(context);
  write_preferences(context);
}

}  // namespace limber::editor
