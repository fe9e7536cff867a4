// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/figure/lettering.h"

#include <algorithm>
#include <cmath>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include "core/base/error.h"
#include "editor/ui/font_files.h"

namespace limber::editor {

namespace {

// Returns the characters of a UTF-8 text. Invalid bytes become the replacement character U+FFFD.
std::vector<char32_t> characters_of(const std::string& text) {
  std::vector<char32_t> result;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    const int more = first < 0x80 ? 0 : first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : -1;
    char32_t character = more == 0 ? first : more > 0 ? first & (0x3F >> more) : 0xFFFD;
    for (int k = 0; k < more; ++k) {
      if (i >= text.size() || (static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) {
        character = 0xFFFD;
        break;
      }
      character = character << 6 | (static_cast<unsigned char>(text[i++]) & 0x3F);
    }
    result.push_back(character);
  }
  return result;
}

// Returns the position after the character that begins at `at`.
std::size_t after_character(const std::string& text, std::size_t at) {
  ++at;
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
  return at;
}

}  // namespace

void draw_over(std::uint8_t* rgba, const glm::ivec3& colour, int alpha) {
  // `under` is the old pixel's share of the new opacity, `sum` the whole new opacity; 255 * 255 is opaque.
  const int under = rgba[3] * (255 - alpha), sum = alpha * 255 + under;
  if (sum == 0) return;
  for (int c = 0; c < 3; ++c)
    rgba[c] = static_cast<std::uint8_t>((colour[c] * alpha * 255 + rgba[c] * under + sum / 2) / sum);
  rgba[3] = static_cast<std::uint8_t>((sum + 127) / 255);
}

struct Lettering::Faces {
  FT_Library library = nullptr;
  FT_Face regular = nullptr, bold = nullptr;

  Faces() {
    if (FT_Init_FreeType(&library) != 0) throw Error("FreeType cannot be started", "fonts", "install libfreetype6");
    open(FontFile::Inter, regular);
    open(FontFile::InterSemiBold, bold);
  }
  ~Faces() {
    if (regular) FT_Done_Face(regular);
    if (bold) FT_Done_Face(bold);
    if (library) FT_Done_FreeType(library);
  }
  Faces(const Faces&) = delete;
  Faces& operator=(const Faces&) = delete;

  void open(FontFile font, FT_Face& face) const {
    const std::string file = font_file(font);
    if (FT_New_Face(library, file.c_str(), 0, &face) != 0)
      throw Error("the font cannot be read", file, "install the package fonts-inter again");
  }
  FT_Face of(bool is_bold) const { return is_bold ? bold : regular; }
};

Lettering::Lettering() : faces_(std::make_unique<Faces>()) {}
Lettering::~Lettering() = default;

double Lettering::width(const std::string& text, bool bold) const {
  const FT_Face face = faces_->of(bold);
  double units = 0;
  for (const char32_t character : characters_of(text))
    if (FT_Load_Glyph(face, FT_Get_Char_Index(face, character), FT_LOAD_NO_SCALE) == 0)
      units += static_cast<double>(face->glyph->metrics.horiAdvance);
  return units / face->units_per_EM;
}

std::vector<std::string> Lettering::lines(const std::string& given, bool bold, double most) const {
  std::vector<std::string> result;
  std::string text = given;  // line ends and tabs count as spaces
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find(' ', at), text.size());
    std::string word = text.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (const std::string longer = line.empty() ? word : line + " " + word; width(longer, bold) <= most) {
      line = longer;
      continue;
    }
    if (!line.empty()) result.push_back(std::move(line));
    line.clear();
    while (width(word, bold) > most) {
      std::size_t cut = after_character(word, 0);
      for (std::size_t next = cut; next < word.size() && width(word.substr(0, next), bold) <= most;
           next = after_character(word, next))
        cut = next;
      if (cut >= word.size()) break;
      result.push_back(word.substr(0, cut));
      word.erase(0, cut);
    }
    line = word;
  }
  if (!line.empty()) result.push_back(line);
  return result;
}

void Lettering::draw(render::Image& image, const std::string& text, bool bold, const glm::dvec2& left_base, double size,
                     int grey) const {
  const FT_Face face = faces_->of(bold);
  if (FT_Set_Char_Size(face, 0, std::max<FT_F26Dot6>(1, std::lround(size * 64)), 72, 72) != 0) return;
  double x = left_base.x;
  for (const char32_t character : characters_of(text)) {
    if (FT_Load_Glyph(face, FT_Get_Char_Index(face, character), FT_LOAD_NO_HINTING | FT_LOAD_NO_BITMAP) != 0) continue;
    const FT_GlyphSlot glyph = face->glyph;
    const double advance = static_cast<double>(glyph->linearHoriAdvance) / 65536;
    const glm::ivec2 whole(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(left_base.y)));
    FT_Outline_Translate(&glyph->outline, std::lround((x - whole.x) * 64), -std::lround((left_base.y - whole.y) * 64));
    x += advance;
    if (FT_Render_Glyph(glyph, FT_RENDER_MODE_NORMAL) != 0) continue;
    const FT_Bitmap& bitmap = glyph->bitmap;
    for (int row = 0; row < static_cast<int>(bitmap.rows); ++row)
      for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
        const glm::ivec2 at(whole.x + glyph->bitmap_left + column, whole.y - glyph->bitmap_top + row);
        if (at.x < 0 || at.y < 0 || at.x >= image.size.x || at.y >= image.size.y) continue;
        draw_over(image.rgba.data() + (static_cast<std::size_t>(at.y) * image.size.x + at.x) * 4, glm::ivec3(grey),
                  bitmap.buffer[row * bitmap.pitch + column]);
      }
  }
}

}  // namespace limber::editor
