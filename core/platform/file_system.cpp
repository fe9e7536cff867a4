// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/file_system.h"

#include <cerrno>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/platform/open_file.h"

namespace limber {

namespace {
std::optional<FileStatus> converted(int failure, const struct stat& status) {
  if (failure != 0) return std::nullopt;
  return FileStatus{.device = status.st_dev,
                    .number = status.st_ino,
                    .size = status.st_size,
                    .seconds = status.st_mtim.tv_sec,
                    .nanoseconds = status.st_mtim.tv_nsec,
                    .is_regular = S_ISREG(status.st_mode),
                    .is_folder = S_ISDIR(status.st_mode),
                    .is_own = status.st_uid == ::geteuid()};
}
}  // namespace

std::optional<FileStatus> status_of_file(const Path& path) {
  struct stat status {};
  return converted(::stat(path.c_str(), &status), status);
}

std::optional<FileStatus> status_of_link(const Path& path) {
  struct stat status {};
  return converted(::lstat(path.c_str(), &status), status);
}

std::optional<FileStatus> status_of_open_file(const Handle& file) {
  struct stat status {};
  return converted(::fstat(file.native(), &status), status);
}

bool is_writable(const Path& path) { return ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) == 0; }

bool is_disk_full(const std::error_code& error) {
  const int reason = error.category() == std::generic_category() ? error.value() : 0;
  return reason == ENOSPC || reason == EDQUOT || reason == EFBIG;
}

Path make_unique_folder(const Path& prefix, std::error_code& error) {
  std::string name = prefix.string() + "XXXXXX";
  error = ::mkdtemp(name.data()) ? std::error_code() : std::error_code(errno, std::generic_category());
  return name;
}

void sync_folder(const Path& folder) {
  std::error_code ignored;
  OpenFile file(folder, Opening::Folder, ignored);
  if (file.is_open()) file.flush();
}

}  // namespace limber
