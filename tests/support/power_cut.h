// SPDX-License-Identifier: AGPL-3.0-or-later
// A disk that loses power. Until then it behaves like any other; at the cut, of what was written since a file's last
// sync each piece of 512 bytes reached the disk or did not, by chance, and so did removals of files whose folder was
// not synced. From the cut on every call fails; restore() gives the folder the contents that the disk had then.
//
// One such disk is there at a time. It is a SQLite VFS around the system's own, and a LogFile for journals.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "core/project/log_file.h"

namespace limber::test {

class PowerCut {
 public:
  // Becomes SQLite's default file system until it goes. The power goes with the `operation`-th write, sync, truncation
  // or removal.
  PowerCut(const Path& folder, std::int64_t operation, std::uint32_t seed);
  ~PowerCut();
  PowerCut(const PowerCut&) = delete;
  PowerCut& operator=(const PowerCut&) = delete;

  OpenLog open_log();
  bool happened() const;
  void restore();  // after all files are closed
  std::int64_t operations() const;

  struct Disk;

 private:
  std::unique_ptr<Disk> disk_;
};

}  // namespace limber::test
