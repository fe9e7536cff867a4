// SPDX-License-Identifier: AGPL-3.0-or-later
// From start to end: the editor in a window until the user quits, or in memory playing a script.
#pragma once

#include <optional>
#include <vector>

#include "core/base/file.h"
#include "editor/context/editor.h"

namespace limber::editor {

struct StartOptions {
  std::vector<Path> files;
  glm::ivec2 size{1600, 900};
  std::optional<double> scale;       // instead of the preferred one
  std::optional<std::string> theme;  // likewise
  Path script;                       // played without a display; empty: a window
};
void run_editor(const StartOptions& options);

}  // namespace limber::editor
