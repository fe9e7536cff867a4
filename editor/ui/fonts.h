// SPDX-License-Identifier: AGPL-3.0-or-later
// The typefaces, rasterized by FreeType for one scale: Inter for words, JetBrains Mono for digits and keys, Font
// Awesome for icons (merged into Inter). Another scale means other fonts, never stretched ones.
#pragma once

struct ImFont;

namespace limber::editor {

struct Fonts {
  ImFont* regular = nullptr;     // 16, icons at 14
  ImFont* semibold = nullptr;    // 16, icons at 14
  ImFont* small = nullptr;       // 14, icons at 12
  ImFont* title = nullptr;       // 32, the start screen's name
  ImFont* mono = nullptr;        // 16
  ImFont* small_mono = nullptr;  // 14, key caps
  ImFont* icons = nullptr;       // 16, icons only: the tool strip
};

// Fills the current ImGui context's atlas anew. Throws Error naming a font file that is not installed.
Fonts build_fonts(double scale);

}  // namespace limber::editor
