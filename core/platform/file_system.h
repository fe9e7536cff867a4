// SPDX-License-Identifier: AGPL-3.0-or-later
// Functions for files and folders that std::filesystem lacks.
#pragma once

#include <cstdint>
#include <optional>
#include <system_error>

#include "core/platform/path.h"

namespace limber {

class Handle;

struct FileStatus {
  std::uint64_t device = 0, number = 0;       // together they identify a file, whatever its name
  std::int64_t size = 0;                      // size of the file, bytes
  std::int64_t seconds = 0, nanoseconds = 0;  // time of the last change, counted from the start of 1970
  bool is_regular = false, is_folder = false;
  bool is_own = false;  // true: the file belongs to the user who runs this process

  bool operator==(const FileStatus&) const = default;
  bool is_same_file(const FileStatus& other) const { return device == other.device && number == other.number; }
};

// Returns the status of a file, after symbolic links are followed; nothing when there is no such file.
std::optional<FileStatus> status_of_file(const Path& path);
// Returns the status of a file; of a symbolic link, the status of the link. Returns nothing when there is no such file.
std::optional<FileStatus> status_of_link(const Path& path);
// Returns the status of an open file (OpenFile::status).
std::optional<FileStatus> status_of_open_file(const Handle& file);

// Returns true if this process may write to the file, or make files in the folder.
bool is_writable(const Path& path);

// Returns true if a write failed because the disk or the user's quota is full, or because the file is too large.
bool is_disk_full(const std::error_code& error);

// Creates a folder with a new name that begins with `prefix`, accessible to the user only, and returns its path.
Path make_unique_folder(const Path& prefix, std::error_code& error);

// Flushes the folder to the disk, so that files created, renamed or removed in it remain so after a power cut.
void sync_folder(const Path& folder);

}  // namespace limber
