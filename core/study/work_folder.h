// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a folder completely or not at all: it is filled under another name beside its final path and then renamed. When
// two programs make the same folder, the second waits and uses what the first has made.
#pragma once

#include "core/base/file.h"
#include "core/base/progress.h"

namespace limber {

class WorkFolder {
 public:
  // Creates and locks an empty working folder, and removes what a killed program left in it. Waits while another
  // program holds the lock. If `place` then exists, made() is true and nothing is left to do. Throws Error where the
  // folder cannot be made, and Cancelled after a cancel while waiting.
  WorkFolder(const Path& place, Progress& progress);
  // Removes the working folder unless commit() has been called.
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  bool made() const { return made_; }
  Path operator/(const std::string& name) const { return working_ / name; }
  void commit();  // renames the working folder to `place`; throws Error
  // Returns whether a megabyte more can be written to the folder.
  bool has_room() const;

 private:
  bool claim();

  Path place_, working_;
  int descriptor_ = -1;
  bool made_ = false;
};

}  // namespace limber
