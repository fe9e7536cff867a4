// SPDX-License-Identifier: AGPL-3.0-or-later
// A user's preferences, which apply to all projects. They are stored in $XDG_CONFIG_HOME/limber/preferences.json;
// $XDG_CONFIG_HOME is ~/.config by default.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "editor/context/layout.h"
#include "editor/input/key_changes.h"

namespace limber::editor {

struct Keymap;

struct Preferences {
  // Preferences of the interface
  std::string theme = "dark";
  double scale = 1;            // scale of the interface relative to the monitor's scale, [0.75, 3]
  double tooltip_delay = 0.5;  // delay before a tool tip appears, s, [0, 3]
  bool reduce_motion = false;

  // What is shown in the views when the editor starts
  bool grid = true, axes = true, scale_bar = true, letters = true, cross_hair = true;
  std::string display = "solid";  // display mode of the 3D view: "solid", "xray" or "tissue"
  bool fine_light = true;         // true: the 3D view gets ray-traced shadows while its picture does not change
  bool refine_at_rest = true;     // true: a pose that does not change is resampled and shown (resample/refined_pose.h)

  // Preferences of the undo history and of automatic saving
  int undo_limit_mb = 1024;  // memory limit of the undo history, MB, [64, 65536]
  int autosave_minutes = 0;  // interval of automatic saving for a project that has a file, [0, 240]; 0: never

  // Preferences of jobs, such as resampling
  int jobs_at_once = 2;       // number of jobs that may run at the same time, [1, 8]
  int worker_memory_mb = 0;   // memory that a resampling may use, MB; 0: no limit
  double worker_minutes = 0;  // time that a resampling may take, minutes; 0: no limit

  // Preferences of folders
  std::string scratch_folder;  // folder for temporary files of a resampling; "": the system's folder

  // The window's regions at the last use; each project stores its own arrangements.
  Arrangements arrangements = default_arrangements();
  std::string keymap = "blender";  // preset of the key map: "blender" or "maya"
  KeyChanges keys;                 // the user's changes of the key map preset
  bool advanced_steps = false;
  std::vector<std::string> recent_commands;  // ids of operators, latest first, at most kMostRecent
  std::map<std::string, int> command_counts;

  static constexpr std::size_t kMostRecent = 20;

  bool operator==(const Preferences&) const = default;
};

Path preferences_path();
// Reads the preferences. Numbers are clamped to their range and unknown entries are ignored. If the file is missing or
// damaged, returns the defaults. If the file is damaged, `problem` says what is wrong.
Preferences read_preferences(const Path& path, std::string& problem);
Preferences preferences_from_json(const std::string& text, std::string& problem);
std::string to_json(const Preferences& preferences);

// Returns one of the program's own key maps, "blender" or "maya".
Keymap keymap_preset(const std::string& name);
}  // namespace limber::editor
