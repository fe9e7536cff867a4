// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/log_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.h"

namespace limber {

namespace {

class PosixLogFile final : public LogFile {
 public:
  explicit PosixLogFile(const Path& path) : where_(path.string()) {
    ::unlink(path.c_str());
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail();
    ::flock(descriptor_, LOCK_EX | LOCK_NB);  // succeeds on a new file where the file system has locks
  }
  ~PosixLogFile() override { ::close(descriptor_); }

  void append(std::string_view bytes) override {
    while (!bytes.empty()) {
      const ssize_t done = ::write(descriptor_, bytes.data(), bytes.size());
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) fail();
      bytes.remove_prefix(static_cast<std::size_t>(done));
    }
  }
  void sync() override {
    if (::fdatasync(descriptor_) != 0) fail();
  }
  void cut(std::int64_t size) override {
    if (::ftruncate(descriptor_, size) != 0) return;  // ignored: readers skip the incomplete record that remains
  }

 private:
  [[noreturn]] void fail() const {
    const bool full = errno == ENOSPC || errno == EDQUOT || errno == EFBIG;
    throw Error("your edits cannot be kept between saves", where_,
                full ? "the disk is full: free some space, or save elsewhere" : std::strerror(errno));
  }
  std::string where_;
  int descriptor_ = -1;
};

bool same_file(int descriptor, const Path& path) {
  struct stat by_descriptor {
  }, by_name{};
  return ::fstat(descriptor, &by_descriptor) == 0 && ::stat(path.c_str(), &by_name) == 0 &&
         by_descriptor.st_dev == by_name.st_dev && by_descriptor.st_ino == by_name.st_ino;
}

}  // namespace

std::unique_ptr<LogFile> open_log(const Path& path) { return std::make_unique<PosixLogFile>(path); }

FileLock::FileLock(const Path& path) {
  constexpr int kAttempts = 100;  // upper limit on attempts: the file may be replaced just before it is locked
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return;
    if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(file);
      return;
    }
    if (same_file(file, path)) {
      descriptor_ = file;
      return;
    }
    ::close(file);
  }
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

void sync_folder(const Path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace limber
