// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a folder completely or not at all, even if programs on several machines make the same folder on a shared disk.
// Each program fills its own working folder beside the final path and then renames it; the first rename wins. A lock
// keeps the other programs from doing the same work. If a shared disk does not pass on locks between machines, two
// machines may do the same work, and the first result is kept.
#pragma once

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/platform/open_file.h"

namespace limber {

enum class IfBusy { Wait, Leave };

class WorkFolder {
 public:
  // Makes an empty working folder, and removes working folders that killed programs of this machine left. If the
  // finished folder `place` exists, made() is true and there is nothing to do. If another program has the lock, waits
  // for it; with IfBusy::Leave it returns instead, with busy() true. Throws Error if the folder cannot be made, and
  // Cancelled if the user cancels during the wait.
  WorkFolder(const Path& place, Progress& progress, IfBusy if_busy = IfBusy::Wait);
  // Removes the working folder unless commit() has been called.
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  bool made() const { return made_; }
  bool busy() const { return !made_ && !locked_.is_open(); }
  Path operator/(const std::string& name) const { return working_ / name; }
  // Renames the working folder to `place`, unless another program has just made it. Throws Error if that fails.
  void commit();
  // Returns true if the disk has room for another megabyte in the folder.
  bool has_room() const;

 private:
  bool claim();
  void remove_leftovers() const;
  void release();

  Path place_, lock_, working_;
  OpenFile locked_;  // the open lock folder
  bool made_ = false;
};

}  // namespace limber
