// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists the folders that file dialogs offer at the left: the project's folder, home and its usual folders, disks, and
// folders of recent files.
#pragma once

#include <string>
#include <vector>

#include "core/platform/path.h"

namespace limber::editor {

struct Context;

struct Place {
  const char* icon;
  std::string name;
  Path path;
};
std::vector<Place> places_of(const Context& context);  // returns the folders of the list that exist
bool is_folder(const Path& path);

}  // namespace limber::editor
