// SPDX-License-Identifier: AGPL-3.0-or-later
// What one user likes, for all projects; kept in $XDG_CONFIG_HOME/limber/preferences.json (~/.config without it).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "editor/context/layout.h"
#include "editor/input/keymap_overrides.h"

namespace limber::editor {

struct Preferences {
  // Interface
  std::string theme = "dark";
  double scale = 1;            // times the monitor's, [0.75, 3]
  double tooltip_delay = 0.5;  // s, [0, 3]
  bool reduce_motion = false;

  // View, as the editor starts
  bool grid = true, axes = true, scale_bar = true, letters = true, cross_hair = true;
  std::string display = "solid";  // "xray", "tissue"

  // Undo and saving
  int undo_limit_mb = 1024;  // [64, 65536]
  int autosave_minutes = 0;  // saves the project's file when it has one; 0: only when asked

  // Jobs
  int jobs_at_once = 2;       // [1, 8]
  int worker_memory_mb = 0;   // that a resampling may take; 0: no limit
  double worker_minutes = 0;  // likewise

  // Folders
  std::string scratch_folder;  // for what a resampling reads and writes; "": the system's

  Arrangements arrangements = default_arrangements();  // as the window was left; a project has its own
  std::string keymap = "blender";                      // the preset: also "maya"
  KeyChanges keys;                                     // from the preset's
  bool advanced_steps = false;
  std::vector<std::string> recent_commands;  // last first, at most kMostRecent
  std::map<std::string, int> command_counts;

  static constexpr std::size_t kMostRecent = 20;

  bool operator==(const Preferences&) const = default;
};

Path preferences_path();
// Values out of range are brought into it, unknown ones left out. A missing file gives the defaults; a damaged one too,
// with a line in `problem`.
Preferences read_preferences(const Path& path, std::string& problem);
Preferences preferences_from_json(const std::string& text, std::string& problem);
std::string to_json(const Preferences& preferences);

// "blender" or "maya", as the program brings it.
Keymap keymap_preset(const std::string& name);
}  // namespace limber::editor
