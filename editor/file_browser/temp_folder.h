// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a temporary folder, which the destructor deletes with its content. If the program crashes first, the next start
// of the program deletes the folder.
#pragma once

#include <memory>

#include "core/base/leftovers.h"

namespace limber::editor {

class ScratchFolder {
 public:
  // Makes the temporary folder. Throws Error when it cannot be made.
  //   inside  the parent folder; "": the system's folder for temporary files
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
