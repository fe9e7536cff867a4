// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/block_drawing.h"

#include <algorithm>
#include <cmath>

#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

ImFont* font_of(const Look& look, Block::Kind kind, Run::Style style) {
  if (kind == Block::Kind::Title) return look.fonts.title;
  if (kind == Block::Kind::Heading || style == Run::Style::Strong) return look.fonts.semibold;
  return style == Run::Style::Code || style == Run::Style::Key ? look.fonts.mono : look.fonts.regular;
}

Colour colour_of(const Look& look, Block::Kind kind, Run::Style style) {
  if (style == Run::Style::Code || style == Run::Style::Key || style == Run::Style::Link) return look.theme.accent_text;
  const bool strong = kind == Block::Kind::Title || kind == Block::Kind::Heading || style == Run::Style::Strong ||
                      style == Run::Style::Name;
  return strong ? look.theme.text : look.theme.text2;
}

// A word of a text, and the place where for_each_word() lays it out.
struct Word {
  const Run& run;
  std::string_view text;
  glm::vec2 where;  // upper left corner of the word, window pixels
  float width;
  int index;   // number of the word in its block, from 0
  float left;  // x coordinate where lines begin, window pixels
};

// Returns the number of bytes of the word that fit into `width` pixels, in whole characters, at least one.
std::size_t bytes_within(ImFont* font, std::string_view word, float width) {
  std::size_t fitting = 0;
  for (std::size_t end = 1; end <= word.size(); ++end) {
    if (end < word.size() && (word[end] & 0xC0) == 0x80) continue;  // a word must not be cut inside a UTF-8 character
    if (fitting > 0 && text_size(font, word.substr(0, end)).x > width) break;
    fitting = end;
  }
  return fitting;
}

// Lays out the words of a block in lines between the x coordinates `left` and `right`, beginning at the y coordinate
// `y`, and calls `draw` for each word. Splits a word that is wider than a line. Returns the y coordinate of the block's
// lower end.
//   line  height of a line, pixels
float for_each_word(const Look& look, const Block& block, float left, float right, float y, float line,
                    const std::function<void(const Word&)>& draw) {
  float x = left;
  int index = 0;
  for (const Run& run : block.runs) {
    ImFont* font = font_of(look, block.kind, run.style);
    const float blank = text_size(font, " ").x;
    for (std::size_t at = 0; at < run.text.size();) {
      if (run.text[at] == ' ') {
        if (x > left) x += blank;
        ++at;
        continue;
      }
      const std::size_t end = std::min(run.text.find(' ', at), run.text.size());
      std::string_view word = std::string_view(run.text).substr(at, end - at);
      float width = text_size(font, word).x;
      if (x > left && x + width > right) {
        x = left;
        y += line;
      }
      if (width > right - left) {
        word = word.substr(0, bytes_within(font, word, right - left));
        width = text_size(font, word).x;
      }
      draw({run, word, {x, y}, width, index++, left});
      x += width;
      at += word.size();
    }
  }
  return y + line;
}

void draw_word(Ui& ui, const Block& block, BlockPlace& place, const Word& word, float line) {
  const Look& look = ui.look;
  ImFont* font = font_of(look, block.kind, word.run.style);
  const Colour colour = colour_of(look, block.kind, word.run.style);
  ImGui::GetWindowDrawList()->AddText(
      font, font->FontSize, im(glm::round(glm::vec2(word.where.x, word.where.y + (line - font->FontSize) / 2))), colour,
      word.text.data(), word.text.data() + word.text.size());
  if (word.run.style != Run::Style::Link) return;
  // If the line has another word of the same link before this one, the space between the words belongs to the link
  // too.
  const bool goes_on = word.text.data() != word.run.text.data() && word.where.x > word.left;
  const float blank = goes_on ? text_size(font, " ").x : 0;
  const Rect rect{word.where - glm::vec2(blank, 0), word.where + glm::vec2(word.width, line)};
  const Pressed pressed = press_area(ui, place.name + "/" + std::to_string(word.index), rect);
  const float under = std::round(rect.centre().y + font->FontSize * 0.42f);
  fill({{rect.low.x, under}, {rect.high.x, under + look.line()}}, with_alpha(colour, pressed.hovered ? 1.0f : 0.4f));
  if (pressed.clicked) place.clicked = word.run.target;
}

float draw_document_picture(Ui& ui, const Block& block, const BlockPlace& place, float y) {
  const Look& look = ui.look;
  const DocumentPicture picture = place.picture ? place.picture(block.picture) : DocumentPicture{};
  if (picture.texture && picture.size.x > 0) {
    const float width = std::min(place.right - place.left, look.px(picture.size.x)),
                height = std::round(width * picture.size.y / picture.size.x);
    const Rect rect{{place.left, y}, {place.left + width, y + height}};
    ImGui::GetWindowDrawList()->AddImageRounded(reinterpret_cast<ImTextureID>(std::uintptr_t(picture.texture)),
                                                im(rect.low), im(rect.high), {0, 0}, {1, 1}, 0xFFFFFFFF, look.px(4));
    outline(rect, look.theme.line2, look.px(4), look.line());
    register_widget(ui, "picture " + block.picture, rect);
    y = rect.high.y + look.px(5);
  }
  const std::string caption = plain_text(block);
  return y + put_wrapped(ui, look.fonts.small, look.theme.text2, {place.left, y}, place.right - place.left, caption);
}

}  // namespace

float gap_below(const Block& block) {
  switch (block.kind) {
    case Block::Kind::Point:
    case Block::Kind::Step: return 6;
    case Block::Kind::Picture: return 16;
    default: return 10;
  }
}

float draw_block(Ui& ui, const Block& block, BlockPlace& place, float y) {
  if (block.kind == Block::Kind::Picture) return draw_document_picture(ui, block, place, y);
  const Look& look = ui.look;
  const float line = block.kind == Block::Kind::Title ? look.px(40) : look.px(22);
  float left = place.left;
  if (block.kind == Block::Kind::Point || block.kind == Block::Kind::Step)
    left += look.px(block.kind == Block::Kind::Step ? 26 : 18);
  if (place.marked) {
    const float bottom = for_each_word(look, block, left, place.right, y, line, [](const Word&) {});
    fill({{place.left - look.px(8), y - look.px(2)}, {place.right + look.px(4), bottom + look.px(2)}},
         look.theme.accent_soft, look.px(4));
  }
  if (block.kind == Block::Kind::Point)
    fill({{place.left + look.px(4), y + look.px(9)}, {place.left + look.px(8), y + look.px(13)}}, look.theme.text3,
         look.px(2));
  if (block.kind == Block::Kind::Step)
    put_text(ui, look.fonts.semibold, look.theme.accent_text, Rect{{place.left, y}, {left - look.px(8), y + line}},
             std::to_string(block.number), Align::Right);
  y = for_each_word(look, block, left, place.right, y, line,
                    [&](const Word& word) { draw_word(ui, block, place, word, line); });
  ui.widgets.add_text(plain_text(block));
  return y;
}

}  // namespace limber::editor
