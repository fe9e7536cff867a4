// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.h"
#include "core/base/leftovers.h"
#include "core/base/memory_pages.h"
#include "core/base/replaced_file.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
// Opens a nameless file in `folder` and returns its descriptor. A nameless file vanishes when the process dies, even by
// SIGKILL. Returns -1 where the file system does not support nameless files.
int open_nameless(const Path& folder, mode_t mode) {
  return ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
}

struct Descriptor {
  int number = -1;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

Error not_written(const Path& path) {
  const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
  return {"the file cannot be written", path.string(),
          full ? "the disk is full: free some space, or write elsewhere" : std::strerror(errno)};
}

}  // namespace

std::string read_file(const Path& path, std::uint64_t limit) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw Error("this is a folder", path.string(), "name a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("the file cannot be opened", path.string(), std::strerror(errno));
  const std::uint64_t size = fs::file_size(path, error);
  if (error) throw Error("this is not a regular file", path.string(), "name a file on disk");
  if (size > limit)
    throw Error("the file has " + std::to_string(size) + " bytes", path.string(),
                "files of this kind may have " + std::to_string(limit) + " bytes at most");
  std::string bytes;
  bytes.reserve(size);
  want_large_pages(bytes.data(), static_cast<std::int64_t>(size));
  bytes.resize(size);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw Error("the file cannot be read to its end", path.string(), "check the disk and try again");
  return bytes;
}

void check_place(const Path& path) {
  std::error_code error;
  if (path.native().find('\0') != std::string::npos)
    throw Error("the name holds a zero byte, at which the system would cut it", path.c_str(), "choose another name");
  const Path folder = path.has_parent_path() ? path.parent_path() : Path(".");
  if (!fs::is_directory(folder, error))
    throw Error("the folder does not exist", folder.string(), "make it first, or write elsewhere");
  if (fs::is_directory(path, error))
    throw Error("a folder stands where the file should go", path.string(), "choose another name");
}

namespace {

// Fills a new file. Calls `write`, which writes to the file through the path `temporary`. Then gives the file the
// permissions of `target`, the file that it will replace, and flushes it to disk.
void fill(int descriptor, const Path& temporary, const Path& target, const Path& path,
          const std::function<void(const Path&)>& write) {
  try {
    write(temporary);
  } catch (const Error& error) {
    throw with_name(error, temporary, path);
  }
  take_permissions(descriptor, target);
  if (::fsync(descriptor) != 0) throw not_written(path);
}

// Returns the permissions with which a new file is created. A file that will replace another one is private at first,
// so that nobody can read it who may not read the other one.
mode_t first_mode(const Path& target) { return ::access(target.c_str(), F_OK) == 0 ? 0600 : 0666; }

}  // namespace

void write_atomically(const Path& path, const std::function<void(const Path&)>& write) {
  check_place(path);
  const Path target = target_of(path);
  check_place(target);
  const Path folder = target.has_parent_path() ? target.parent_path() : Path(".");
  const Path name = temporary_name(target);
  const Descriptor nameless{open_nameless(folder, first_mode(target))};
  if (nameless.number >= 0) {
    const std::string from = "/proc/self/fd/" + std::to_string(nameless.number);
    fill(nameless.number, from, target, path, write);
    if (::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, target.c_str(), AT_SYMLINK_FOLLOW) == 0) return;
    if (errno != EEXIST) throw not_written(path);
    // linkat() cannot replace an existing file. So the file is linked to a temporary name first and then renamed.
    const Unfinished unfinished(name);
    if (::linkat(AT_FDCWD, from.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) throw not_written(path);
    if (::rename(name.c_str(), target.c_str()) != 0) throw not_written(path);
    return;
  }
  const Unfinished unfinished(name);
  const Descriptor named{::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, first_mode(target))};
  if (named.number < 0) throw not_written(path);
  fill(named.number, name, target, path, write);
  if (::rename(name.c_str(), target.c_str()) != 0) throw not_written(path);
}

void write_file_atomically(const Path& path, const std::string& bytes) {
  write_atomically(path, [&](const Path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) throw Error("the file cannot be written", path.string(), "check permissions and free space");
  });
}

}  // namespace limber
