// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/draw.h"

#include "editor/ui/tooltip.h"

namespace limber::editor {

namespace {

ImDrawList& canvas() { return *ImGui::GetWindowDrawList(); }

// Shortens a text to `width` pixels. Returns the longest beginning of the text that fits together with "...", followed
// by "...". The text is cut between UTF-8 characters. Returns "" if not even one character fits.
std::string cut_to(ImFont* font, std::string_view text, float width) {
  std::size_t length = text.size();
  const auto inside_character = [&] {
    return length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0) == 0x80;
  };
  while (length > 0) {
    do --length;
    while (length > 0 && inside_character());
    const std::string cut = std::string(text.substr(0, length)) + "...";
    if (text_size(font, cut).x <= width) return cut;
  }
  return "";
}

// Shortens a text to `lines` lines, wrapped to `width`. Returns the whole text if it fits, else its beginning and
// "...".
std::string cut_to_lines(ImFont* font, const std::string& text, float width, int lines) {
  const char *at = text.c_str(), *end = at + text.size();
  for (int line = 1; line < lines && at < end; ++line) {
    at = font->CalcWordWrapPositionA(1, at, end, width);
    while (at < end && (*at == ' ' || *at == '\n')) ++at;
  }
  const std::string_view rest(at, static_cast<std::size_t>(end - at));
  if (font->CalcWordWrapPositionA(1, at, end, width) == end) return text;
  return std::string(text.c_str(), at) + cut_to(font, rest, width);
}

}  // namespace

void fill(const Rect& rect, Colour colour, float rounding) {
  canvas().AddRectFilled(im(rect.low), im(rect.high), colour, rounding);
}

void outline(const Rect& rect, Colour colour, float rounding, float width) {
  const Rect inside{rect.low + 0.5f * (width - 1), rect.high - 0.5f * (width - 1)};
  canvas().AddRect(im(inside.low), im(inside.high), colour, rounding, 0, width);
}

glm::vec2 text_size(ImFont* font, std::string_view text) {
  return from_im(font->CalcTextSizeA(font->FontSize, FLT_MAX, 0, text.data(), text.data() + text.size()));
}

float put_text(Ui& ui, ImFont* font, Colour colour, const glm::vec2& where, std::string_view text) {
  const glm::vec2 corner = glm::round(where);
  canvas().AddText(font, font->FontSize, im(corner), colour, text.data(), text.data() + text.size());
  ui.widgets.add_text(std::string(text));
  return corner.x + text_size(font, text).x;
}

void put_text(Ui& ui, ImFont* font, Colour colour, const Rect& in, std::string_view text, Align align) {
  if (in.width() <= 0) return;
  glm::vec2 size = text_size(font, text);
  const bool whole = size.x <= in.width() + 0.5f;
  const std::string shown = whole ? std::string(text) : cut_to(font, text, in.width());
  if (!whole) size = text_size(font, shown);
  const float x = align == Align::Left    ? in.low.x
                  : align == Align::Right ? in.high.x - size.x
                                          : in.centre().x - size.x / 2;
  const glm::vec2 corner = glm::round(glm::vec2(x, in.centre().y - size.y / 2));
  canvas().AddText(font, font->FontSize, im(corner), colour, shown.data(), shown.data() + shown.size());
  ui.widgets.add_text(std::string(text));
  if (!whole && ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem) &&
      in.contains(from_im(ImGui::GetIO().MousePos)))
    tooltip(ui, in, std::string(text), "");
}

float height_of_wrapped(ImFont* font, const std::string& text, float width, int most_lines) {
  const std::string shown = most_lines > 0 ? cut_to_lines(font, text, width, most_lines) : text;
  return font->CalcTextSizeA(font->FontSize, FLT_MAX, width, shown.c_str()).y;
}

float put_wrapped(Ui& ui, ImFont* font, Colour colour, const glm::vec2& where, float width, const std::string& text,
                  int most_lines) {
  const std::string shown = most_lines > 0 ? cut_to_lines(font, text, width, most_lines) : text;
  const glm::vec2 corner = glm::round(where);
  canvas().AddText(font, font->FontSize, im(corner), colour, shown.c_str(), nullptr, width);
  ui.widgets.add_text(text);
  const float height = font->CalcTextSizeA(font->FontSize, FLT_MAX, width, shown.c_str()).y;
  const Rect place{corner, corner + glm::vec2(width, height)};
  if (shown != text && ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem) &&
      place.contains(from_im(ImGui::GetIO().MousePos)))
    tooltip(ui, place, "", text);
  return height;
}

void put_icon(ImFont* font, Colour colour, const Rect& in, const char* icon) {
  const glm::vec2 size = text_size(font, icon), corner = glm::round(in.centre() - size * 0.5f);
  ImGui::GetWindowDrawList()->AddText(font, font->FontSize, im(corner), colour, icon);
}

float width_of_key_caps(const Ui& ui, const std::vector<std::string>& caps) {
  const Look& look = ui.look;
  float width = 0;
  for (const std::string& cap : caps)
    width += std::max(look.px(18), text_size(look.fonts.small_mono, cap).x + look.px(10)) + look.px(4);
  return caps.empty() ? 0 : width - look.px(4);
}

void put_bone_icon(const Look& look, const Rect& in, Colour colour) {
  const glm::vec2 middle = in.centre();
  const float wide = look.px(4), high = look.px(6);
  ImGui::GetWindowDrawList()->AddQuadFilled({middle.x, middle.y - high}, {middle.x + wide, middle.y - high / 3},
                                            {middle.x, middle.y + high}, {middle.x - wide, middle.y - high / 3},
                                            colour);
}

float put_key_caps(Ui& ui, float x, float y, const std::vector<std::string>& caps) {
  const Look& look = ui.look;
  for (const std::string& cap : caps) {
    const float width = std::max(look.px(18), text_size(look.fonts.small_mono, cap).x + look.px(10));
    const Rect rect{{std::round(x), std::round(y - look.px(18) / 2)},
                    {std::round(x + width), std::round(y - look.px(18) / 2) + look.px(18)}};
    fill(rect, look.theme.raised, look.px(3));
    outline(rect, look.theme.line2, look.px(3), look.line());
    put_text(ui, look.fonts.small_mono, look.theme.text, rect, cap, Align::Centre);
    x = rect.high.x + look.px(4);
  }
  return caps.empty() ? x : x - look.px(4);
}

}  // namespace limber::editor
