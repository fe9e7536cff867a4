// SPDX-License-Identifier: AGPL-3.0-or-later
// The editor's current look: theme, typefaces and scale. Sizes in the code are pixels at scale 1; Look::px() converts
// them to pixels of the window.
#pragma once

#include <cmath>

#include "editor/ui/fonts.h"
#include "editor/ui/theme.h"

namespace limber::editor {

struct Look {
  Theme theme;
  Fonts fonts;
  float scale = 0;

  float px(float size) const { return std::round(size * scale); }
  float line() const { return std::fmax(1.0f, std::floor(scale)); }
};

// Applies theme and scale to the look and to ImGui's own widgets in the current context. Rebuilds the fonts only when
// the scale has changed. Returns true if the caller must upload the fonts' texture again.
//   theme  "dark" or "light"
bool apply_look(Look& look, const std::string& theme, float scale);

}  // namespace limber::editor
