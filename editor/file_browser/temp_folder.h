// SPDX-License-Identifier: AGPL-3.0-or-later
// A folder for files on their way: empty at first, gone with all that is in it at the end; after a crash, at the next
// start.
#pragma once

#include <memory>

#include "core/base/leftovers.h"

namespace limber::editor {

class ScratchFolder {
 public:
  //   inside  "": where the system keeps such files
  //   throws Error when it cannot be made
  explicit ScratchFolder(const std::string& inside);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  Path operator/(const std::string& name) const { return path_ / name; }
  const Path& path() const { return path_; }

 private:
  Path path_;
  std::unique_ptr<Unfinished> unfinished_;
};

}  // namespace limber::editor
