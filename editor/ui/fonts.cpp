// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/fonts.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <imgui.h>
#include <imgui_freetype.h>

#include "core/base/error.h"

namespace limber::editor {

namespace {

constexpr char kInter[] = "/usr/share/fonts/opentype/inter/Inter-Regular.otf";
constexpr char kInterSemiBold[] = "/usr/share/fonts/opentype/inter/Inter-SemiBold.otf";
constexpr char kMono[] = "/usr/share/fonts/truetype/jetbrains-mono/JetBrainsMono-Regular.ttf";
constexpr char kIcons[] = "/usr/share/fonts/truetype/font-awesome/fontawesome-webfont.ttf";

// Ranges of Unicode characters to rasterize. Each pair of numbers is the first and last character of a range. kText has
// Latin with all accents, Greek, Cyrillic, punctuation, arrows, superscript and subscript digits, the minus sign.
constexpr ImWchar kText[] = {0x20,   0x24F,  0x370,  0x3FF,  0x400,  0x4FF,  0x1E00, 0x1EFF, 0x2010,
                             0x205E, 0x2070, 0x209F, 0x2190, 0x2193, 0x2212, 0x2212, 0};
constexpr ImWchar kLatin[] = {0x20, 0xFF, 0x2010, 0x2026, 0x2190, 0x2193, 0x2212, 0x2212, 0};
constexpr ImWchar kIconRange[] = {0xF000, 0xF2E0, 0};

void check_present(const char* path, const char* package) {
  if (!std::filesystem::exists(path))
    throw Error("a font is missing", path, std::string("install the package ") + package);
}

class Builder {
 public:
  explicit Builder(double scale) : scale_(scale) {}

  ImFont* text(const char* path, int size, const ImWchar* range, int icon_size) {
    ImFontConfig config;
    config.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
    ImFont* font = atlas().AddFontFromFileTTF(path, pixels(size), &config, range);
    if (icon_size) icons(icon_size, true, std::round((size - icon_size) / 2.0 * scale_));
    return font;
  }

  ImFont* icons(int size, bool merged, double lower) {
    ImFontConfig config;
    config.FontBuilderFlags = ImGuiFreeTypeBuilderFlags_LightHinting;
    config.MergeMode = merged;
    config.GlyphMinAdvanceX = pixels(16);
    config.GlyphOffset.y = static_cast<float>(lower);
    return atlas().AddFontFromFileTTF(kIcons, pixels(size), &config, kIconRange);
  }

 private:
  static ImFontAtlas& atlas() { return *ImGui::GetIO().Fonts; }
  float pixels(int size) const { return static_cast<float>(std::round(size * scale_)); }
  double scale_;
};

}  // namespace

Fonts build_fonts(double scale) {
  check_present(kInter, "fonts-inter");
  check_present(kInterSemiBold, "fonts-inter");
  check_present(kMono, "fonts-jetbrains-mono");
  check_present(kIcons, "fonts-font-awesome");
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  atlas.FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  atlas.TexDesiredWidth = scale > 1.3 ? 4096 : 2048;  // pixels; OpenGL 3.3 guarantees 1024, current drivers allow 8192
  atlas.Flags |= ImFontAtlasFlags_NoPowerOfTwoHeight;

  Builder build(scale);
  Fonts fonts;
  fonts.regular = build.text(kInter, 16, kText, 14);
  fonts.semibold = build.text(kInterSemiBold, 16, kText, 14);
  fonts.small = build.text(kInter, 14, kText, 12);
  fonts.title = build.text(kInterSemiBold, 32, kLatin, 0);
  fonts.mono = build.text(kMono, 16, kLatin, 0);
  fonts.small_mono = build.text(kMono, 14, kLatin, 0);
  fonts.icons = build.icons(16, false, 0);
  if (!atlas.Build()) throw Error("the fonts cannot be prepared", kInter, "install the package fonts-inter again");
  return fonts;
}

}  // namespace limber::editor
