// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/named_files.h"

namespace limber::editor {

struct OpenProject {
  Path path;                      // file of the project; empty: never saved
  std::string name;               // the name of the project, or of the volume opened last
  std::vector<NamedFile> inputs;  // files from which the project's data was read; they are never overwritten
  std::vector<Path> to_open;      // files dropped on the window or given on the command line
};

}  // namespace limber::editor
