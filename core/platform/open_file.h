// SPDX-License-Identifier: AGPL-3.0-or-later
// An open file or folder: reads and writes at positions, flushes to the disk, holds a lock, and gets a name only when
// it is complete. Failures are returned as std::error_code, whose message() names the system's reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/platform/file_system.h"
#include "core/platform/path.h"

namespace limber {

// Owns an open file descriptor: of a file, a folder, or an end of a pipe or socket. The programs that this process
// starts do not inherit it.
class Handle {
 public:
  using Native = int;
  Handle() = default;
  explicit Handle(Native native) : native_(native) {}
  Handle(Handle&& other) noexcept : native_(std::exchange(other.native_, kNone)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(native_, other.native_);
    return *this;
  }
  ~Handle() { close(); }

  bool is_open() const { return native_ != kNone; }
  // Closes the handle, if it is open. Returns an error if the last bytes could not be written.
  std::error_code close();
  // Returns the system's own identifier of the open file. Only core/platform calls this.
  Native native() const { return native_; }

 private:
  static constexpr Native kNone = -1;
  Native native_ = kNone;
};

enum class Opening {
  Read,       // reads an existing file; opening does not wait for a writer of a pipe
  Folder,     // opens an existing folder, to lock it or to flush it to the disk
  Overwrite,  // writes only; an existing file is emptied
  New,        // reads and writes; fails when the name exists, even as a link
  NewLog,     // like New, but each write appends to the file
};

struct OpeningRules {
  bool is_private = false;    // true: only the owner can read a file that is created
  bool follows_links = true;  // false: fails when the path is a symbolic link
};

class OpenFile {
 public:
  enum class Lock { Taken, Busy, Unsupported };

  OpenFile() = default;
  explicit OpenFile(Handle handle) : handle_(std::move(handle)) {}
  // Opens the file. When this fails, is_open() is false and `error` is set.
  OpenFile(const Path& path, Opening opening, std::error_code& error, const OpeningRules& rules = {});
  // Creates a file without a name in `folder`. It vanishes when the process dies, even by SIGKILL, unless give_name()
  // was called. The result is not open where the file system has no such files.
  static OpenFile nameless(const Path& folder, const OpeningRules& rules = {});

  bool is_open() const { return handle_.is_open(); }
  const Handle& handle() const { return handle_; }
  std::optional<FileStatus> status() const;
  std::int64_t size() const;  // returns the file's size, bytes
  // Reads `size` bytes from `offset` on and returns how many were read: fewer at the end of the file and on failure.
  std::size_t read_at(std::int64_t offset, void* to, std::size_t size) const;

  // Writes all bytes, at the end of what was written before.
  std::error_code write(std::string_view bytes);
  std::error_code write_at(std::int64_t offset, std::string_view bytes);
  std::error_code cut(std::int64_t size);  // shortens the file to `size` bytes
  std::error_code close() { return handle_.close(); }
  // flush() returns when the file's bytes, times and permissions are on the disk; flush_bytes() only waits for bytes
  // and size.
  std::error_code flush();
  std::error_code flush_bytes();

  // Tries to lock the file exclusively. The lock ends when the file is closed or the process ends.
  Lock lock();

  // Returns, for a nameless file, a path by which other code can open it while this file is open.
  Path path_while_open() const;
  // Gives the nameless file a name. Fails with std::errc::file_exists when the name exists.
  std::error_code give_name(const Path& path);
  // Gives the file the permissions, and where allowed the owner and group, of the file `replaced`. Does nothing when
  // `replaced` does not exist.
  void take_permissions(const Path& replaced);

 private:
  Handle handle_;
};

}  // namespace limber
