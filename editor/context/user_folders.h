// SPDX-License-Identifier: AGPL-3.0-or-later
// The folders in which the editor stores its own files, chosen by the XDG Base Directory Specification.
#pragma once

#include "core/base/file.h"

namespace limber::editor {

// The folders for the editor's own files. If a path is empty, no files of that kind are stored.
struct Folders {
  Path config;  // folder for settings and the list of recent files
  Path cache;   // folder for small pictures of files; may be deleted at any time
  Path edits;   // folder for journals (logs of edits) of projects that were never saved
};

// Returns the folders $XDG_CONFIG_HOME/limber (by default ~/.config/limber), $XDG_CACHE_HOME/limber (by default
// ~/.cache/limber) and $XDG_STATE_HOME/limber/edits.
Folders user_folders();

// Returns the path as text. Inside the user's home it is shortened to the form "~/anatomy/arm.mha".
std::string short_path(const Path& path);

}  // namespace limber::editor
