// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws rectangles, text, icons and key caps (framed names of keys) into the current ImGui window. Sizes are pixels of
// the window.
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
// Draws one line of text with its top left corner at `where`. Returns the x of the text's right end.
float put_text(Ui& ui, ImFont* font, Colour colour, const glm::vec2& where, std::string_view text);
enum class Align { Left, Centre, Right };
// Draws one line of text, vertically centred in the rectangle. A text that is too long is cut and ends in "..."; its
// tool tip then shows the whole text.
void put_text(Ui& ui, ImFont* font, Colour colour, const Rect& in, std::string_view text, Align align = Align::Left);
// Draws text wrapped to `width`, with its top left corner at `where`. Returns the height of the drawn text. If
// `most_lines` > 0, a longer text is cut to `most_lines` lines and ends in "..."; its tool tip then shows the whole
// text.
float put_wrapped(Ui& ui, ImFont* font, Colour colour, const glm::vec2& where, float width, const std::string& text,
                  int most_lines = 0);
float height_of_wrapped(ImFont* font, const std::string& text, float width, int most_lines = 0);
// Draws an icon in the middle of the rectangle.
void put_icon(ImFont* font, Colour colour, const Rect& in, const char* icon);
// Draws the symbol of a bone, a filled quadrilateral, in the middle of the rectangle.
void put_bone_icon(const Look& look, const Rect& in, Colour colour);
// Draws key caps (the names of keys in frames) in a row that begins at `x` and is vertically centred at `y`. Returns
// the x of the row's right end.
float put_key_caps(Ui& ui, float x, float y, const std::vector<std::string>& caps);
float width_of_key_caps(const Ui& ui, const std::vector<std::string>& caps);

}  // namespace limber::editor
