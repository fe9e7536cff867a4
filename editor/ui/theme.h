// SPDX-License-Identifier: AGPL-3.0-or-later
// The colours of the editor by what they are for, read from assets/themes/NAME.json ("RRGGBB"). One accent (blue) is
// what is chosen in the chrome, one selection colour (orange) what is selected in the scene; never swapped.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/file.h"

namespace limber::editor {

using Colour = std::uint32_t;  // as ImGui packs it: 0xAABBGGRR

struct Theme {
  std::string name;
  Colour void_ = 0;  // gaps between regions
  Colour panel = 0, head = 0, raised = 0, hover = 0, active = 0, field = 0, row_alt = 0, line = 0, line2 = 0;
  Colour text = 0, text2 = 0, text3 = 0;  // value, label, hint
  Colour accent = 0, accent_soft = 0, accent_text = 0, on_accent = 0;
  Colour select = 0, select_light = 0, on_select = 0;
  Colour ok = 0, warn = 0, error = 0;
  Colour axis[3] = {};
  Colour view_top = 0, view_bottom = 0, view_text = 0, view_text2 = 0, view_plate = 0;  // dark in every theme
};

// Throws Error for a file that is no theme, naming the first colour that is missing or unreadable.
Theme read_theme(const Path& path);

Colour with_alpha(Colour colour, float alpha);   // [0, 1]
Colour rgb(float red, float green, float blue);  // [0, 1]
// WCAG 2: (lighter + 0.05) / (darker + 0.05), [1, 21].
double contrast(Colour a, Colour b);

}  // namespace limber::editor
