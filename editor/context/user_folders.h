// SPDX-License-Identifier: AGPL-3.0-or-later
// Where the editor keeps what it remembers between sessions, after the XDG rules.
#pragma once

#include "core/base/file.h"

namespace limber::editor {

// An empty path: nothing of that kind is kept.
struct Folders {
  Path config;  // settings, recent files
  Path cache;   // small pictures; may vanish at any time
  Path edits;   // journals of projects that were never saved
};

// $XDG_CONFIG_HOME/limber (~/.config/limber), $XDG_CACHE_HOME/limber (~/.cache/limber), $XDG_STATE_HOME/limber/edits.
Folders user_folders();

// "~/anatomy/arm.mha" for what lies in the user's home.
std::string short_path(const Path& path);
Path home_folder();  // "/" when there is none

}  // namespace limber::editor
