// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/panels/operator_box.h"

#include "editor/fields.h"

namespace limber::editor {

void operator_box(Editor& editor, std::string_view id, const Rect& rect, const std::string& label) {
  const Operator& op = *find_operator(editor, id);
  const Look& look = editor.look;
  const bool can_run = why_not(editor, op).empty(), on = op.checked(editor);
  const Pressed pressed = press_area(editor, label, rect, can_run);
  const float side = look.px(16), y = std::round(rect.centre().y - side / 2);
  checkbox_mark(editor, {{rect.low.x, y}, {rect.low.x + side, y + side}}, on, pressed.hovered && can_run);
  put_text(editor, look.fonts.regular, can_run ? look.theme.text : look.theme.text3, Rect{{rect.low.x + side + look.px(6), rect.low.y}, rect.high}, label);
  if (pressed.hovered) operator_tooltip(editor, op, rect);
  if (pressed.clicked) run(editor, op);
}

}  // namespace limber::editor
