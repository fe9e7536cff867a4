// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a folder completely or not at all: a working folder with another name, beside the final path, is filled and
// then renamed. If two programs make the same folder, the second one waits and uses the folder of the first one.
#pragma once

#include "core/base/file.h"
#include "core/base/progress.h"

namespace limber {

class WorkFolder {
 public:
  // Creates and locks an empty working folder; removes files that a killed program left in it. Waits while another
  // program holds the lock. If the finished folder `place` then exists, made() is true and nothing is left to do.
  // Throws Error if the folder cannot be made, and Cancelled if the user cancels during the wait.
  WorkFolder(const Path& place, Progress& progress);
  // Removes the working folder unless commit() has been called.
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  bool made() const { return made_; }
  Path operator/(const std::string& name) const { return working_ / name; }
  void commit();  // renames the working folder to `place`; throws Error
  // Returns true if the disk has room for another megabyte in the folder.
  bool has_room() const;

 private:
  bool claim();

  Path place_, working_;
  int descriptor_ = -1;
  bool made_ = false;
};

}  // namespace limber
