// SPDX-License-Identifier: AGPL-3.0-or-later
// A file that is only ever appended to, locked by whoever has it open. Behind an interface, so that tests can lose what
// a power cut would lose.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "core/base/file.h"

namespace limber {

class LogFile {
 public:
  virtual ~LogFile() = default;
  virtual void append(std::string_view bytes) = 0;  // all of them, or throws Error and the file may have grown by some
  virtual void sync() = 0;                          // on the disk, or throws Error
  virtual void cut(std::int64_t size) = 0;          // back to that size; best effort
};

// A new empty file in place of whatever has that name. throws Error
using OpenLog = std::function<std::unique_ptr<LogFile>(const Path&)>;
std::unique_ptr<LogFile> open_log(const Path& path);

// Another's file, held while this lives. The lock is the system's (flock): it goes when the process ends, however it
// ends.
class FileLock {
 public:
  FileLock() = default;
  // Nothing is locked when another process has it, or when there is no such file: taken() says so.
  explicit FileLock(const Path& path);
  ~FileLock();
  FileLock(FileLock&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  FileLock& operator=(FileLock&& other) noexcept;
  bool taken() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

// The folder's names are on the disk: files made, renamed or removed in it stay so.
void sync_folder(const Path& folder);

}  // namespace limber
