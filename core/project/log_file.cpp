// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/log_file.h"

#include "core/base/error.h"

namespace limber {

namespace {

class SystemLogFile final : public LogFile {
 public:
  explicit SystemLogFile(const Path& path) : where_(path.string()) {
    std::error_code error;
    std::filesystem::remove(path, error);
    file_ = OpenFile(path, Opening::NewLog, error);
    require_success(error);
    file_.lock();  // succeeds on a new file, if the file system supports locks
  }

  void append(std::string_view bytes) override { require_success(file_.write(bytes)); }
  void sync() override { require_success(file_.flush_bytes()); }
  void cut(std::int64_t size) override { file_.cut(size); }  // may fail: readers skip an incomplete record that remains

 private:
  void require_success(const std::error_code& error) const {
    if (!error) return;
    throw Error("unsaved edits cannot be written to disk", where_,
                is_disk_full(error) ? "the disk is full: free some space, or save elsewhere" : error.message());
  }
  std::string where_;
  OpenFile file_;
};

bool same_file(const OpenFile& file, const Path& path) {
  const auto opened = file.status(), named = status_of_file(path);
  return opened && named && opened->is_same_file(*named);
}

}  // namespace

std::unique_ptr<LogFile> open_log(const Path& path) { return std::make_unique<SystemLogFile>(path); }

FileLock::FileLock(const Path& path) {
  // Upper limit on attempts; an attempt fails if the file is replaced just before it is locked.
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::error_code error;
    OpenFile file(path, Opening::Read, error);
    if (error || file.lock() == OpenFile::Lock::Busy) return;
    if (!same_file(file, path)) continue;
    file_ = std::move(file);
    return;
  }
}

}  // namespace limber
