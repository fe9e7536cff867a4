// SPDX-License-Identifier: AGPL-3.0-or-later
// Rasterizes the editor's fonts by FreeType: Inter for words, JetBrains Mono for digits and keys, Font Awesome for
// icons (merged into Inter). The fonts are built for one scale of the interface, and built again when the scale
// changes, because stretched characters look blurred.
#pragma once

struct ImFont;

namespace limber::editor {

struct Fonts {
  ImFont* regular = nullptr;     // for most texts; 16 px at scale 1, its icons 14 px
  ImFont* semibold = nullptr;    // bold texts; 16 px at scale 1, its icons 14 px
  ImFont* small = nullptr;       // small texts; 14 px at scale 1, its icons 12 px
  ImFont* title = nullptr;       // 32 px at scale 1: the program's name on the start screen
  ImFont* mono = nullptr;        // fixed-width digits; 16 px at scale 1
  ImFont* small_mono = nullptr;  // 14 px at scale 1: key caps
  ImFont* icons = nullptr;       // 16 px at scale 1, icons only: the tool strip
};

// Builds the fonts into the current ImGui context's atlas, which is cleared first. Throws Error, which names the file,
// when a font file is not installed.
Fonts build_fonts(double scale);

}  // namespace limber::editor
