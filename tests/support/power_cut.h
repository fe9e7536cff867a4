// SPDX-License-Identifier: AGPL-3.0-or-later
// Simulates a disk that loses power. Before the cut it behaves like any other disk. At the cut, each piece of 512 bytes
// that was written to a file since the file's last sync reaches the disk or not, by chance. The same holds for a
// removed file whose folder was not synced. After the cut every call fails. restore() sets the folder to the contents
// that the disk had at the cut.
//
// Only one PowerCut may exist at a time. It consists of a SQLite VFS (file system layer) around the system's own VFS,
// and of a LogFile for journals.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "core/project/log_file.h"

namespace limber::test {

class PowerCut {
 public:
  // Becomes SQLite's default file system until the destructor runs. The power is cut at the write, sync, truncation or
  // removal with the number `operation`.
  PowerCut(const Path& folder, std::int64_t operation, std::uint32_t seed);
  ~PowerCut();
  PowerCut(const PowerCut&) = delete;
  PowerCut& operator=(const PowerCut&) = delete;

  OpenLog open_log();
  bool happened() const;
  void restore();  // call it after all files are closed
  std::int64_t operations() const;

  struct Disk;

 private:
  std::unique_ptr<Disk> disk_;
};

}  // namespace limber::test
