// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/fonts.h"

#include <cmath>
#include <string>
#include <utility>

#include <imgui.h>
#include <imgui_freetype.h>

#include "core/base/error.h"
#include "editor/ui/font_files.h"

namespace limber::editor {

namespace {

// Ranges of Unicode characters to rasterize. Each pair of numbers is the first and last character of a range. kText has
// Latin with all accents, Greek, Cyrillic, punctuation, arrows, superscript and subscript digits, the minus sign.
constexpr ImWchar kText[] = {0x20,   0x24F,  0x370,  0x3FF,  0x400,  0x4FF,  0x1E00, 0x1EFF, 0x2010,
                             0x205E, 0x2070, 0x209F, 0x2190, 0x2193, 0x2212, 0x2212, 0};
constexpr ImWchar kLatin[] = {0x20, 0xFF, 0x2010, 0x2026, 0x2190, 0x2193, 0x2212, 0x2212, 0};
constexpr ImWchar kIconRange[] = {0xF000, 0xF2E0, 0};

class Builder {
 public:
  Builder(double scale, std::string icons) : scale_(scale), icons_(std::move(icons)) {}

  ImFont* text(const std::string& path, int size, const ImWchar* range, int icon_size) {
    ImFontConfig config;
    config.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
    ImFont* font = atlas().AddFontFromFileTTF(path.c_str(), pixels(size), &config, range);
    if (icon_size) icons(icon_size, true, std::round((size - icon_size) / 2.0 * scale_));
    return font;
  }

  ImFont* icons(int size, bool merged, double lower) {
    ImFontConfig config;
    config.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
    config.MergeMode = merged;
    config.GlyphMinAdvanceX = pixels(16);
    config.GlyphOffset.y = static_cast<float>(lower);
    return atlas().AddFontFromFileTTF(icons_.c_str(), pixels(size), &config, kIconRange);
  }

 private:
  static ImFontAtlas& atlas() { return *ImGui::GetIO().Fonts; }
  float pixels(int size) const { return static_cast<float>(std::round(size * scale_)); }
  double scale_;
  std::string icons_;  // file of the icons' font
};

}  // namespace

Fonts build_fonts(double scale) {
  const std::string regular = font_file(FontFile::Inter), semibold = font_file(FontFile::InterSemiBold),
                    mono = font_file(FontFile::JetBrainsMono);
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  // Width of the texture with all characters, pixels. OpenGL 3.3 guarantees only 1024, but current drivers allow 8192.
  atlas.TexDesiredWidth = scale > 1.3 ? 4096 : 2048;
  atlas.Flags |= ImFontAtlasFlags_NoPowerOfTwoHeight;

  Builder build(scale, font_file(FontFile::FontAwesome));
  Fonts fonts;
  fonts.regular = build.text(regular, 16, kText, 14);
  fonts.semibold = build.text(semibold, 16, kText, 14);
  fonts.small = build.text(regular, 14, kText, 12);
  fonts.title = build.text(semibold, 32, kLatin, 0);
  fonts.mono = build.text(mono, 16, kLatin, 0);
  fonts.small_mono = build.text(mono, 14, kLatin, 0);
  fonts.icons = build.icons(16, false, 0);
  if (!atlas.Build()) throw Error("the fonts cannot be prepared", regular, "install the package fonts-inter again");
  return fonts;
}

}  // namespace limber::editor
