// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs the editor from start to end: in a window until the user quits, or in memory while it plays a script.
#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"
#include "editor/app/editor.h"

namespace limber::editor {

struct StartOptions {
  std::vector<Path> files;
  glm::ivec2 size{1600, 900};
  std::optional<double> scale;       // interface scale; no value: the scale in the preferences
  std::optional<std::string> theme;  // "dark" or "light" in place of the preferences' theme
  Path script;                       // script to play without a display; empty: opens a window
};
void run_editor(const StartOptions& options);

}  // namespace limber::editor
