// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/work_folder.h"

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

namespace {
// Returns the name of this machine, with only those characters that are safe in a file name, and a "-" behind it.
std::string machine_prefix() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  std::string safe;
  for (const char* c = name; *c; ++c)
    if (std::isalnum(static_cast<unsigned char>(*c)) || *c == '.') safe += *c;
  return safe + "-";
}

Path working_path(const Path& place, const std::string& owner) {
  return place.parent_path() / ("." + place.filename().string() + "." + owner + ".working");
}
}  // namespace

WorkFolder::WorkFolder(const Path& place, Progress& progress, IfBusy if_busy)
    : place_(place),
      lock_(place.parent_path() / ("." + place.filename().string() + ".lock")),
      working_(working_path(place, machine_prefix() + std::to_string(::getpid()))) {
  while (!made_ && !claim()) {
    if (if_busy == IfBusy::Leave) return;
    if (progress.cancelled()) throw Cancelled();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

// Locks the lock's folder, and makes the working folder. The lock belongs to the open file descriptor, so the system
// releases it when the program is killed. Returns false if another program has the lock.
bool WorkFolder::claim() {
  if (fs::exists(place_)) return made_ = true;
  if (::mkdir(lock_.c_str(), 0777) != 0 && errno != EEXIST)
    throw Error("the folder cannot be written", lock_.parent_path().string(), std::strerror(errno));
  descriptor_ = ::open(lock_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0 && errno != ENOENT)
    throw Error("the folder cannot be opened", lock_.string(), std::strerror(errno));
  const bool locked = descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  // The program that had the lock may just have finished and removed the opened folder. Checks that it is still there.
  struct stat mine {
  }, there{};
  if (!locked || ::fstat(descriptor_, &mine) != 0 || ::stat(lock_.c_str(), &there) != 0 ||
      mine.st_ino != there.st_ino) {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    return false;
  }
  if (fs::exists(place_)) {  // made between the first look and the lock
    release();
    return made_ = true;
  }
  remove_leftovers();
  write_file_atomically(lock_ / working_.filename().string().substr(1), "");
  if (::mkdir(working_.c_str(), 0777) != 0)
    throw Error("the folder cannot be written", working_.parent_path().string(), std::strerror(errno));
  return true;
}

// The lock's folder holds a file for each working folder, with its name without the dot. Removes those of this machine:
// as this program has the lock, the programs that made them are dead. A program on another machine may yet be alive,
// where the disk does not carry locks.
void WorkFolder::remove_leftovers() const {
  const std::string start = place_.filename().string() + "." + machine_prefix();
  for (const auto& entry : fs::directory_iterator(lock_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(start)) continue;
    fs::remove_all(place_.parent_path() / ("." + name));
    fs::remove(entry.path());
  }
}

// Removes the lock's folder, and with it the lock.
void WorkFolder::release() {
  std::error_code ignored;
  if (made_ || fs::exists(place_, ignored)) {  // nobody needs the other working folders any more
    for (const auto& entry : fs::directory_iterator(lock_, ignored))
      fs::remove_all(place_.parent_path() / ("." + entry.path().filename().string()), ignored);
    fs::remove_all(lock_, ignored);
  } else {
    fs::remove(lock_ / working_.filename().string().substr(1), ignored);
    fs::remove(lock_, ignored);
  }
  ::close(descriptor_);
  descriptor_ = -1;
}

WorkFolder::~WorkFolder() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  fs::remove_all(working_, ignored);
  release();
}

void WorkFolder::commit() {
  std::error_code error;
  fs::rename(working_, place_, error);
  if (error && !fs::exists(place_))
    throw Error("the folder cannot be put in its place", place_.string(), error.message());
  made_ = true;
  std::error_code ignored;
  fs::remove_all(working_, ignored);
  release();
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
