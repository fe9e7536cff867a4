// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/work_folder.h"

#include <chrono>
#include <thread>

#include "core/base/error.h"
#include "core/platform/host.h"
#include "core/platform/process.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
// Returns the name of this machine, with only those characters that are safe in a file name, and a "-" behind it.
std::string machine_prefix() {
  std::string safe;
  for (const char c : host_name())
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '.') safe += c;
  return safe + "-";
}

Path working_path(const Path& place, const std::string& owner) {
  return place.parent_path() / ("." + place.filename().string() + "." + owner + ".working");
}
}  // namespace

WorkFolder::WorkFolder(const Path& place, Progress& progress, IfBusy if_busy)
    : place_(place),
      lock_(place.parent_path() / ("." + place.filename().string() + ".lock")),
      working_(working_path(place, machine_prefix() + std::to_string(process_id()))) {
  while (!made_ && !claim()) {
    if (if_busy == IfBusy::Leave) return;
    if (progress.cancelled()) throw Cancelled();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

// Locks the lock folder and makes the working folder. The lock belongs to the open folder, so the system releases it
// when the program is killed. Returns false if another program has the lock.
bool WorkFolder::claim() {
  if (fs::exists(place_)) return made_ = true;
  std::error_code error;
  fs::create_directory(lock_, error);
  if (error && error != std::errc::file_exists)
    throw Error("the folder cannot be written", lock_.parent_path().string(), error.message());
  OpenFile opened(lock_, Opening::Folder, error);
  if (error && error != std::errc::no_such_file_or_directory)
    throw Error("the folder cannot be opened", lock_.string(), error.message());
  if (!opened.is_open() || opened.lock() != OpenFile::Lock::Taken) return false;
  // The program that had the lock may have removed the folder after it was opened here. Checks that the folder still
  // exists.
  const auto mine = opened.status(), there = status_of_file(lock_);
  if (!mine || !there || mine->number != there->number) return false;
  locked_ = std::move(opened);
  if (fs::exists(place_)) {  // another program made the finished folder before this one got the lock
    release();
    return made_ = true;
  }
  remove_leftovers();
  write_file_atomically(lock_ / working_.filename().string().substr(1), "");
  if (!fs::create_directory(working_, error))
    throw Error("the folder cannot be written", working_.parent_path().string(),
                error ? error.message() : working_.filename().string() + " is there already");
  return true;
}

// Removes the working folders that programs of this machine made: these programs are dead, since this program has the
// lock. Programs of other machines may still be alive, because some shared disks do not pass on locks. The working
// folders are found by the files in the lock folder, which have the same names without the first dot.
void WorkFolder::remove_leftovers() const {
  const std::string start = place_.filename().string() + "." + machine_prefix();
  for (const auto& entry : fs::directory_iterator(lock_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(start)) continue;
    fs::remove_all(place_.parent_path() / ("." + name));
    fs::remove(entry.path());
  }
}

// Removes the lock folder, which also removes the lock.
void WorkFolder::release() {
  std::error_code ignored;
  if (made_ || fs::exists(place_, ignored)) {  // the folder is finished: no working folder is needed
    for (const auto& entry : fs::directory_iterator(lock_, ignored))
      fs::remove_all(place_.parent_path() / ("." + entry.path().filename().string()), ignored);
    fs::remove_all(lock_, ignored);
  } else {
    fs::remove(lock_ / working_.filename().string().substr(1), ignored);
    fs::remove(lock_, ignored);
  }
  locked_.close();
}

WorkFolder::~WorkFolder() {
  if (!locked_.is_open()) return;
  std::error_code ignored;
  fs::remove_all(working_, ignored);
  release();
}

void WorkFolder::commit() {
  std::error_code error;
  fs::rename(working_, place_, error);
  if (error && !fs::exists(place_))
    throw Error("the folder cannot be renamed to its final name", place_.string(), error.message());
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
