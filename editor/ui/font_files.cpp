// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/font_files.h"

#include <filesystem>

#include "core/base/asset.h"
#include "core/base/error.h"

namespace limber::editor {

namespace {

// The paths at which Debian's packages install the fonts, in the order of FontFile.
constexpr struct {
  const char *file, *package;
} kFonts[] = {{"/usr/share/fonts/opentype/inter/Inter-Regular.otf", "fonts-inter"},
              {"/usr/share/fonts/opentype/inter/Inter-SemiBold.otf", "fonts-inter"},
              {"/usr/share/fonts/truetype/jetbrains-mono/JetBrainsMono-Regular.ttf", "fonts-jetbrains-mono"},
              {"/usr/share/fonts/truetype/font-awesome/fontawesome-webfont.ttf", "fonts-font-awesome"}};

}  // namespace

std::string font_file(FontFile font) {
  const auto& [file, package] = kFonts[static_cast<int>(font)];
  const std::filesystem::path path = file;
  if (const auto own = find_asset("fonts/" + path.filename().string())) return own->string();
  if (std::filesystem::exists(path)) return file;
  throw Error("a font is missing", file, std::string("install the package ") + package);
}

}  // namespace limber::editor
