// SPDX-License-Identifier: AGPL-3.0-or-later
// How the editor looks now: theme, typefaces and scale. Sizes in the code are pixels at scale 1; px() makes them the
// window's.
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

// Theme and fonts for ImGui's own widgets, in the current context. Rebuilds what changed: the fonts only with the
// scale.
//   theme  "dark" or "light"
// returns whether the fonts' texture must be made anew
bool apply_look(Look& look, const std::string& theme, float scale);

}  // namespace limber::editor
