// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/work_folder.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/error.h"

namespace limber {

namespace fs = std::filesystem;

WorkFolder::WorkFolder(const Path& place, Progress& progress)
    : place_(place),
      working_(place.parent_path() / ("." + place.filename().string() + ".working")) {
  while (!made_ && !claim()) {
    if (progress.cancelled()) throw Cancelled();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

// Locks the working folder, which has another name until it is complete. The lock belongs to the open file descriptor,
// so the system releases it when the program is killed. Returns false if another program has the lock.
bool WorkFolder::claim() {
  if (fs::exists(place_)) return made_ = true;
  if (::mkdir(working_.c_str(), 0777) != 0 && errno != EEXIST)
    throw Error("the folder cannot be written", working_.parent_path().string(), std::strerror(errno));
  descriptor_ = ::open(working_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0 && errno != ENOENT)
    throw Error("the folder cannot be opened", working_.string(), std::strerror(errno));
  const bool locked = descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  // The program that had the lock may just have renamed the opened folder to `place_`. Checks that the folder still has
  // its working name.
  struct stat mine {
  }, there{};
  if (!locked || ::fstat(descriptor_, &mine) != 0 || ::stat(working_.c_str(), &there) != 0 ||
      mine.st_ino != there.st_ino) {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    return false;
  }
  for (const auto& entry : fs::directory_iterator(working_)) fs::remove_all(entry.path());
  return true;
}

WorkFolder::~WorkFolder() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  fs::remove_all(working_, ignored);
  ::close(descriptor_);
}

void WorkFolder::commit() {
  std::error_code error;
  fs::rename(working_, place_, error);
  if (error) throw Error("the folder cannot be put in its place", place_.string(), error.message());
  ::close(descriptor_);
  descriptor_ = -1;
}

bool WorkFolder::has_room() const {
  try {
    write_file_atomically(working_ / "room", std::string(1 << 20, '\0'));
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace limber
