// SPDX-License-Identifier: AGPL-3.0-or-later
// The user's own act failed: what happened, where, what to do. Stays until it is read.
#include "editor/dialog.h"
#include "editor/icons.h"
#include "editor/panels/panels.h"

namespace limber::editor {

namespace {

float put_wrapped(Editor& editor, Colour colour, const glm::vec2& where, float width, const std::string& text) {
  ImFont* font = editor.look.fonts.regular;
  ImGui::GetWindowDrawList()->AddText(font, font->FontSize, im(where), colour, text.c_str(), nullptr, width);
  editor.widgets.add_text(text);
  return font->CalcTextSizeA(font->FontSize, FLT_MAX, width, text.c_str()).y;
}

}  // namespace

void draw_error_message(Editor& editor) {
  if (editor.messages.errors.empty()) return;
  const ErrorMessage message = editor.messages.errors.front();
  const Look& look = editor.look;
  const std::string title = message.times > 1 ? message.what + " (" + std::to_string(message.times) + " times)" : message.what;
  const Rect rect = begin_dialog(editor, "Message", 480, 210);
  const Rect whole{{rect.low.x - look.px(18), rect.low.y - look.px(54)}, rect.high + look.px(18)};
  fill({whole.low + glm::vec2(look.px(6), 0), {whole.high.x - look.px(6), whole.low.y + look.px(3)}}, look.theme.error);
  put_icon(look.fonts.regular, look.theme.error, Rect{rect.low, rect.low + look.px(20)}, icon::kError);
  const float left = rect.low.x + look.px(30), width = rect.high.x - left;
  put_text(editor, look.fonts.semibold, look.theme.text, Rect{{left, rect.low.y}, {rect.high.x, rect.low.y + look.px(20)}}, title);
  float y = rect.low.y + look.px(26);
  y += put_wrapped(editor, look.theme.text2, {left, y}, width, message.where) + look.px(8);
  put_wrapped(editor, look.theme.text, {left, y}, width, message.what_to_do);
  const glm::vec2 size{look.px(80), look.px(28)}, copy_size{look.px(136), look.px(28)};
  const glm::vec2 corner = rect.high - size;
  if (button(editor, "Copy message", {{corner.x - look.px(8) - copy_size.x, corner.y}, {corner.x - look.px(8), rect.high.y}}, {icon::kCopy, "Copy message"}))
    editor.host.set_clipboard(message.what + ": " + message.where + ": " + message.what_to_do);
  if (button(editor, "Close", {corner, rect.high}, {"", "Close", ButtonStyle::Primary})) editor.messages.errors.erase(editor.messages.errors.begin());
  end_dialog(editor);
}

}  // namespace limber::editor
