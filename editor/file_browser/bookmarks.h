// SPDX-License-Identifier: AGPL-3.0-or-later
// Where file dialogs lead with one click: the project's folder, home and its usual folders, disks, folders of recent
// files.
#pragma once

#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct Place {
  const char* icon;
  std::string name;
  Path path;
};
std::vector<Place> places_of(const Editor& editor);  // those that are there
bool is_folder(const Path& path);

}  // namespace limber::editor
