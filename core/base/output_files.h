// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes several files that belong together: when writing one of them fails, the new files that were written before are
// removed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/file.h"

namespace limber {

class Outputs {
 public:
  Outputs() = default;
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;
  ~Outputs() {
    std::error_code ignored;
    if (!complete_)
      for (const Path& path : written_) std::filesystem::remove(path, ignored);
  }
  // Registers files that will be written, so that they are removed on failure. Files that already exist now are not
  // removed.
  void expect(const std::vector<Path>& paths) {
    std::error_code unreadable;
    for (const Path& path : paths)
      if (!std::filesystem::exists(path, unreadable)) written_.push_back(path);
  }
  template <class Write>
  void write(const std::string& path, const Write& write) {
    if (path.empty()) return;
    std::error_code unreadable;
    const bool is_new = !std::filesystem::exists(path, unreadable);
    write();
    if (is_new) written_.push_back(path);
  }
  void complete() { complete_ = true; }

 private:
  std::vector<Path> written_;
  bool complete_ = false;
};

}  // namespace limber
