// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/file_browser/bookmarks.h"

#include "core/platform/desktop.h"
#include "editor/context/context.h"
#include "editor/context/open_project.h"
#include "editor/context/recent_files.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kRecentFolders = 6;

// Appends the mounted disks and memory sticks to the list of bookmarks, until it has 13 entries.
void add_volumes(std::vector<Place>& places) {
  for (const Path& folder : mounted_folders()) {
    if (places.size() > 12) return;
    places.push_back({icon::kVolume, folder.filename().string(), folder});
  }
}

}  // namespace

bool is_folder(const Path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::vector<Place> places_of(const Context& context) {
  std::vector<Place> places;
  const auto add = [&](const char* icon, const std::string& name, const Path& path) {
    if (!is_folder(path)) return;
    for (const Place& place : places)
      if (place.path == path) return;
    places.push_back({icon, name, path});
  };
  const Path home = home_folder();
  if (!context.project->path.empty()) add(icon::kFolder, "Project's folder", context.project->path.parent_path());
  add(icon::kFolder, "Home", home);
  for (const char* name : {"Desktop", "Documents", "Downloads"}) add(icon::kFolder, name, home / name);
  add(icon::kVolume, "Computer", "/");
  add_volumes(places);
  const std::size_t most = places.size() + kRecentFolders;
  const auto add_recent = [&](const Path& folder) {
    if (places.size() < most) add(icon::kHistory, folder.filename().string(), folder);
  };
  for (const Path& folder : context.recent_files->recent_folders) add_recent(folder);
  for (const Recent& one : context.recent_files->recents) add_recent(one.path.parent_path());
  return places;
}

}  // namespace limber::editor
