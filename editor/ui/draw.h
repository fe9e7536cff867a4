// SPDX-License-Identifier: AGPL-3.0-or-later
// Drawing into the current window: rectangles, lines of text, key caps. Sizes are pixels of the window.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <imgui.h>

#include "editor/ui/ui.h"

namespace limber::editor {

inline ImVec2 im(const glm::vec2& v) { return {v.x, v.y}; }
inline glm::vec2 from_im(const ImVec2& v) { return {v.x, v.y}; }

void fill(const Rect& rect, Colour colour, float rounding = 0);
void outline(const Rect& rect, Colour colour, float rounding = 0, float width = 1);
glm::vec2 text_size(ImFont* font, std::string_view text);
// `where` is the text's top left corner. Returns its right end.
float put_text(Ui& ui, ImFont* font, Colour colour, const glm::vec2& where, std::string_view text);
enum class Align { Left, Centre, Right };
// One line in the vertical middle of the rectangle; too long a text ends in "...", and pointing at it shows it whole.
void put_text(Ui& ui, ImFont* font, Colour colour, const Rect& in, std::string_view text, Align align = Align::Left);
// Lines as long as `width`, from the top left corner on; returns their height. With `most_lines` the last one ends in
// "..." where there would be more, and pointing at them shows the whole.
float put_wrapped(Ui& ui, ImFont* font, Colour colour, const glm::vec2& where, float width, const std::string& text,
                  int most_lines = 0);
float height_of_wrapped(ImFont* font, const std::string& text, float width, int most_lines = 0);
// An icon in the middle of the rectangle.
void put_icon(ImFont* font, Colour colour, const Rect& in, const char* icon);
// A bone's quad in the middle of the rectangle.
void put_bone_icon(const Look& look, const Rect& in, Colour colour);
// Caps beside one another; returns the right end. `y` is the middle.
float put_key_caps(Ui& ui, float x, float y, const std::vector<std::string>& caps);
float width_of_key_caps(const Ui& ui, const std::vector<std::string>& caps);

}  // namespace limber::editor
