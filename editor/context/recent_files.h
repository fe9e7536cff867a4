// SPDX-License-Identifier: AGPL-3.0-or-later
// What the editor remembers for comfort, beside the preferences: recent files, the folders that were looked
// into, how far the tour has come. Losing it loses no work, so a damaged file is set aside with a message.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"

namespace limber::editor {

struct Recent {
  Path path;              // absolute
  std::int64_t time = 0;  // s since 1970, when it was opened or saved last

  bool operator==(const Recent&) const = default;
};

struct RecentFiles {
  std::vector<Recent> recents;          // latest first
  std::map<std::string, Path> folders;  // of file dialogs, by purpose
  std::vector<Path> recent_folders;     // of file dialogs, latest first
  bool show_start = true;
  bool hidden_files = false;
  int tour_step = 0;

  bool operator==(const RecentFiles&) const = default;
};

// What of it is on the disk.
struct RecentFilesOnDisk {
  RecentFiles contents;
  std::vector<Recent> named;         // those that have operators
  std::optional<double> changed_at;  // the editor's time
  bool failure_told = false;
};

void add_recent(RecentFiles& recent_files, const Path& path, std::int64_t time);
void add_recent_folder(RecentFiles& recent_files, const Path& folder);
void forget_recent(RecentFiles& recent_files, const Path& path);

// `warning` says why a file could not be used; it is then set aside as NAME.damaged. A missing file is no failure.
RecentFiles read_recent_files(const Path& file, std::string& warning);
// Throws Error when it cannot be written.
void write_recent_files(const RecentFiles& recent_files, const Path& file);

// Text of a file of settings that should be a JSON object with this schema; "" when there is none. A damaged one is set
// aside.
std::string read_settings_text(const Path& file, const std::string& schema, std::string& warning);

}  // namespace limber::editor
