// SPDX-License-Identifier: AGPL-3.0-or-later
// The colours of the editor, named by their purpose. They are read from assets/themes/NAME.json, where they are
// written as "RRGGBB". The accent colour (blue) marks selected rows and buttons in panels. The selection colour
// (orange) marks selected bones and tissues in the views.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/file.h"

namespace limber::editor {

using Colour = std::uint32_t;  // 0xAABBGGRR, as in ImGui

struct Theme {
  std::string name;
  Colour void_ = 0;  // colour of the gaps between the window's regions
  Colour panel = 0, head = 0, raised = 0, hover = 0, active = 0, field = 0, row_alt = 0, line = 0, line2 = 0;
  Colour text = 0, text2 = 0, text3 = 0;  // colours of the text of values, labels and hints
  Colour accent = 0, accent_soft = 0, accent_text = 0, on_accent = 0;
  Colour select = 0, select_light = 0, on_select = 0;
  Colour ok = 0, warn = 0, error = 0;
  Colour axis[3] = {};
  // Colours in the views, which are dark in every theme.
  Colour view_top = 0, view_bottom = 0, view_text = 0, view_text2 = 0, view_plate = 0;
};

// Reads a theme. Throws Error if the file is no theme, or if a colour is missing or unreadable; the Error names this
// colour.
Theme read_theme(const Path& path);

Colour with_alpha(Colour colour, float alpha);   // returns the colour with an opacity in [0, 1]
Colour rgb(float red, float green, float blue);  // returns an opaque colour; each argument is in [0, 1]
// Returns the contrast ratio of WCAG 2, (lighter + 0.05) / (darker + 0.05), in [1, 21].
double contrast(Colour a, Colour b);

}  // namespace limber::editor
