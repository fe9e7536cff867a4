// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/preferences.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/platform/desktop.h"
#include "editor/input/keymap_overrides.h"
#include "editor/ui/asset_path.h"

namespace limber::editor {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kLargestFile = 4 << 20;

}  // namespace

Path preferences_path() {
  const Path folder = user_folder(UserFolder::Config);
  return (folder.empty() ? Path(".config") : folder) / "limber" / "preferences.json";
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
  // Renames the damaged file, so that it is not lost and the next start does not read it again.
  const Path aside = path.string() + ".damaged";
  std::filesystem::rename(path, aside, ignored);
  problem = Error(problem, path.string(), "the defaults are used; the old file is kept as " + aside.filename().string())
                .what();
  return preferences;
}

Keymap keymap_preset(const std::string& name) {
  const Keymap blender = read_keymap(asset("keymap.json"));
  if (name != "maya") return blender;
  const Json json = Json::parse(read_file(asset("keymap_maya.json")), nullptr, false);
  return changed(blender, key_changes_from_json(json.at("keys").dump()));
}

}  // namespace limber::editor
