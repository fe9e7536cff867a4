// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/user_folders.h"

#include <cstdlib>

#include "core/project/journal.h"

namespace limber::editor {

namespace {

Path folder_of(const char* variable, const char* below_home) {
  const char* set = std::getenv(variable);
  return (set && *set == '/' ? Path(set) : home_folder() / below_home) / "limber";
}

}  // namespace

Path home_folder() {
  const char* home = std::getenv("HOME");
  return home && *home == '/' ? Path(home) : Path("/");
}

Folders user_folders() {
  return {folder_of("XDG_CONFIG_HOME", ".config"), folder_of("XDG_CACHE_HOME", ".cache"), edits_folder()};
}

std::string short_path(const Path& path) {
  const std::string home = home_folder().string(), text = path.string();
  if (home.size() > 1 && text == home) return "~";
  return home.size() > 1 && text.starts_with(home + "/") ? "~" + text.substr(home.size()) : text;
}

}  // namespace limber::editor
