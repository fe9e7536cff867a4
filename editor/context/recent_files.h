// SPDX-License-Identifier: AGPL-3.0-or-later
// Stores the recent files, the folders last used in file dialogs and the tour's progress between runs of the program.
// The stored file holds no work of the user's. If it is damaged, it is therefore renamed with a warning, and the
// program starts without it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"

namespace limber::editor {

struct Recent {
  Path path;              // absolute path of the file
  std::int64_t time = 0;  // when the file was last opened or saved, s since 1970

  bool operator==(const Recent&) const = default;
};

struct RecentFiles {
  std::vector<Recent> recents;          // recent files, the latest first
  std::map<std::string, Path> folders;  // last folder of each file dialog, by the dialog's purpose
  std::vector<Path> recent_folders;     // folders used in any file dialog, latest first
  bool show_start = true;
  bool hidden_files = false;
  int tour_step = 0;

  bool operator==(const RecentFiles&) const = default;
};

// The recent files as they were last written to the disk. The editor writes its recent files again when they differ
// from these.
struct RecentFilesOnDisk {
  RecentFiles contents;
  std::vector<Recent> named;         // the recent files for which operators such as "file.recent_1" exist
  std::optional<double> changed_at;  // time of the first change that is not written yet, seconds on the editor's clock
  bool failure_told = false;         // true: the user has been told that writing failed
};

void add_recent(RecentFiles& recent_files, const Path& path, std::int64_t time);
void add_recent_folder(RecentFiles& recent_files, const Path& folder);
void forget_recent(RecentFiles& recent_files, const Path& path);

// Reads the recent files. If the file cannot be used, `warning` says why; a damaged file is renamed NAME.damaged. A
// missing file gives no warning.
RecentFiles read_recent_files(const Path& file, std::string& warning);
// Writes the recent files. Throws Error when the file cannot be written.
void write_recent_files(const RecentFiles& recent_files, const Path& file);

// Returns the text of a settings file, which must be a JSON object with this schema. Returns "" if the file is missing
// or damaged. A damaged file is renamed NAME.damaged, and `warning` says so.
std::string read_settings_text(const Path& file, const std::string& schema, std::string& warning);

}  // namespace limber::editor
