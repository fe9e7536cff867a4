// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/open_file.h"

#include <cerrno>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace limber {

namespace {

std::error_code last_error() { return {errno, std::generic_category()}; }
std::error_code error_if(bool failed) { return failed ? last_error() : std::error_code(); }

int flags_of(Opening opening) {
  switch (opening) {
    case Opening::Read: return O_RDONLY | O_NONBLOCK;
    case Opening::Folder: return O_RDONLY | O_DIRECTORY;
    case Opening::Overwrite: return O_WRONLY | O_CREAT | O_TRUNC;
    case Opening::New: return O_RDWR | O_CREAT | O_EXCL;
    case Opening::NewLog: return O_RDWR | O_CREAT | O_EXCL | O_APPEND;
  }
  return O_RDONLY;
}

mode_t mode_of(const OpeningRules& rules) { return rules.is_private ? 0600 : 0666; }

}  // namespace

std::error_code Handle::close() {
  const Native native = std::exchange(native_, kNone);
  return error_if(native != kNone && ::close(native) != 0);
}

OpenFile::OpenFile(const Path& path, Opening opening, std::error_code& error, const OpeningRules& rules)
    : handle_(::open(path.c_str(), flags_of(opening) | O_CLOEXEC | (rules.follows_links ? 0 : O_NOFOLLOW),
                     mode_of(rules))) {
  error = error_if(!is_open());
}

OpenFile OpenFile::nameless(const Path& folder, const OpeningRules& rules) {
  return OpenFile(Handle(::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode_of(rules))));
}

std::optional<FileStatus> OpenFile::status() const { return status_of_open_file(handle_); }

std::int64_t OpenFile::size() const { return ::lseek(handle_.native(), 0, SEEK_END); }

std::size_t OpenFile::read_at(std::int64_t offset, void* to, std::size_t size) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got =
        ::pread(handle_.native(), static_cast<char*>(to) + done, size - done, offset + static_cast<std::int64_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

std::error_code OpenFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(handle_.native(), bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return last_error();
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return {};
}

std::error_code OpenFile::write_at(std::int64_t offset, std::string_view bytes) {
  const ssize_t done = ::pwrite(handle_.native(), bytes.data(), bytes.size(), offset);
  return error_if(done != static_cast<ssize_t>(bytes.size()));
}

std::error_code OpenFile::cut(std::int64_t size) { return error_if(::ftruncate(handle_.native(), size) != 0); }
std::error_code OpenFile::flush() { return error_if(::fsync(handle_.native()) != 0); }
std::error_code OpenFile::flush_bytes() { return error_if(::fdatasync(handle_.native()) != 0); }

OpenFile::Lock OpenFile::lock() {
  if (::flock(handle_.native(), LOCK_EX | LOCK_NB) == 0) return Lock::Taken;
  return errno == EWOULDBLOCK ? Lock::Busy : Lock::Unsupported;
}

Path OpenFile::path_while_open() const { return "/proc/self/fd/" + std::to_string(handle_.native()); }

std::error_code OpenFile::give_name(const Path& path) {
  const Path open = path_while_open();
  return error_if(::linkat(AT_FDCWD, open.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) != 0);
}

void OpenFile::take_permissions(const Path& replaced) {
  struct stat status {};
  if (::stat(replaced.c_str(), &status) != 0) return;
  // The owner is set before the permissions, because a change of owner clears some permissions. Only root may set the
  // owner; a process of another user sets only the group.
  const int file = handle_.native();
  if (::fchown(file, status.st_uid, status.st_gid) != 0 && ::fchown(file, static_cast<uid_t>(-1), status.st_gid) != 0)
    status.st_mode &= ~static_cast<mode_t>(S_ISUID | S_ISGID);
  // On a file system without permissions fchmod() fails. Then the file keeps the restrictive permissions that it was
  // opened with.
  [[maybe_unused]] const int refused = ::fchmod(file, status.st_mode & 07777);
}

}  // namespace limber
