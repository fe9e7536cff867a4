// SPDX-License-Identifier: AGPL-3.0-or-later
// The user's folders, disks and default programs.
#pragma once

#include <vector>

#include "core/platform/path.h"

namespace limber {

// Returns the folder in which programs keep a user's files of one kind, chosen by the XDG Base Directory Specification:
// $XDG_CONFIG_HOME (by default ~/.config), $XDG_CACHE_HOME (~/.cache) and $XDG_STATE_HOME (~/.local/state). Empty when
// neither the variable nor the user's home is an absolute path.
enum class UserFolder { Config, Cache, State };
Path user_folder(UserFolder kind);

Path home_folder();  // returns the user's home folder; "/" when there is none

// Returns the folders at which the desktop has mounted disks and memory sticks.
std::vector<Path> mounted_folders();

// Opens the file in the desktop's default program for this kind of file. This process neither waits for that program
// nor ends it. Returns false when the desktop cannot open files.
bool open_in_default_program(const Path& path);

}  // namespace limber
