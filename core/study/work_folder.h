// SPDX-License-Identifier: AGPL-3.0-or-later
// A folder whole or not at all: filled under another name beside its place, then renamed. Two programs that would fill
// the same one do not disturb each other: the second waits, and takes what the first has made.
#pragma once

#include "core/base/file.h"
#include "core/base/progress.h"

namespace limber {

class WorkFolder {
 public:
  // Empty, or what a killed program left there is cleared. When `place` came to be meanwhile, made() is true and there
  // is nothing to do.
  //   throws Error where it cannot be made, Cancelled while another program works on it
  WorkFolder(const Path& place, Progress& progress);
  // Without commit() everything in it goes.
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  bool made() const { return made_; }
  Path operator/(const std::string& name) const { return working_ / name; }
  void commit();  // throws Error
  // Whether a megabyte more can be written there.
  bool has_room() const;

 private:
  bool claim();

  Path place_, working_;
  int descriptor_ = -1;
  bool made_ = false;
};

}  // namespace limber
