// SPDX-License-Identifier: AGPL-3.0-or-later
// A file that is only appended to, and locked by the process that has it open. LogFile is an interface, so that tests
// can simulate a power cut by dropping the bytes that were not synced.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "core/base/file.h"
#include "core/platform/open_file.h"

namespace limber {

class LogFile {
 public:
  virtual ~LogFile() = default;
  virtual void append(std::string_view bytes) = 0;  // appends all bytes; an Error may leave some of them appended
  virtual void sync() = 0;                          // returns when all bytes are on the disk, or throws Error
  virtual void cut(std::int64_t size) = 0;          // shortens the file to `size` bytes; failures are ignored
};

// Creates an empty file at the path, in place of any existing file. Throws Error when the file cannot be created.
using OpenLog = std::function<std::unique_ptr<LogFile>(const Path&)>;
std::unique_ptr<LogFile> open_log(const Path& path);

// Holds a lock on a file that another process may own, as long as this object lives. The lock is the system's, so it
// ends with the process, however the process ends.
class FileLock {
 public:
  FileLock() = default;
  // Tries to lock the file. When another process has the lock or there is no such file, taken() returns false.
  explicit FileLock(const Path& path);
  bool taken() const { return file_.is_open(); }

 private:
  OpenFile file_;
};

}  // namespace limber
