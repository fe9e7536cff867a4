// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/user_folders.h"

#include "core/platform/desktop.h"
#include "core/project/journal.h"

namespace limber::editor {

namespace {

Path own_folder(UserFolder kind) {
  const Path folder = user_folder(kind);
  return (folder.empty() ? home_folder() : folder) / "limber";
}

}  // namespace

Folders user_folders() { return {own_folder(UserFolder::Config), own_folder(UserFolder::Cache), edits_folder()}; }

std::string short_path(const Path& path) {
  const std::string home = home_folder().string(), text = path.string();
  if (home.size() > 1 && text == home) return "~";
  return home.size() > 1 && text.starts_with(home + "/") ? "~" + text.substr(home.size()) : text;
}

}  // namespace limber::editor
