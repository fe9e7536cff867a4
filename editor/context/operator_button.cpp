// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_button.h"

#include "editor/context/pointer_context.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

void operator_tooltip(Editor& editor, const Operator& op, const Rect& rect) {
  const std::string reason = disabled_reason(editor, op);
  tooltip(editor, rect, op.label, reason.empty() ? op.description : op.description + "\n" + reason,
          editor.keymap.chord_of(op.id, contexts(editor)));
}

bool operator_button(Editor& editor, std::string_view id, const Rect& rect, const std::string& label,
                     ButtonStyle style) {
  const Operator* op = find_operator(editor, id);
  if (!op) return false;
  const std::string reason = disabled_reason(editor, *op);
  const bool clicked = button(editor, std::string(id), rect, {op->icon, label, style, reason.empty()});
  if (ImGui::IsItemHovered()) operator_tooltip(editor, *op, rect);
  if (clicked) run(editor, *op);
  return clicked;
}

void operator_menu_item(Editor& editor, std::string_view id) {
  const Operator* op = find_operator(editor, id);
  if (!op) return;
  const auto chord = editor.keymap.chord_of(op->id, contexts(editor));
  const bool enabled = disabled_reason(editor, *op).empty(), on = op->checked && op->checked(editor);
  const Look& look = editor.look;
  const std::vector<std::string> caps = chord ? key_caps(*chord) : std::vector<std::string>{};
  const float width = std::max(look.px(190), text_size(look.fonts.regular, op->label).x + look.px(34 + 28) +
                                                 width_of_key_caps(editor, caps) + look.px(10));
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::PushID(op->id.c_str());
  const bool clicked =
      ImGui::Selectable("##item", false, enabled ? 0 : ImGuiSelectableFlags_Disabled, ImVec2(width, look.px(22)));
  ImGui::PopID();
  const float wide = std::max(width, ImGui::GetContentRegionAvail().x);
  const Rect rect{from_im(corner), {corner.x + wide, corner.y + look.px(22)}};
  register_widget(editor, op->label, rect, enabled);
  const Colour colour = enabled ? look.theme.text : look.theme.text3;
  put_icon(look.fonts.regular, enabled ? look.theme.text2 : look.theme.text3,
           Rect{{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}},
           on ? icon::kTick : op->icon);
  put_text(editor, look.fonts.regular, colour, Rect{{rect.low.x + look.px(34), rect.low.y}, {rect.high.x, rect.high.y}},
           op->label);
  put_key_caps(editor, rect.high.x - look.px(8) - width_of_key_caps(editor, caps), rect.centre().y, caps);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
    const Rect beside{{rect.low.x, rect.low.y}, {rect.high.x, rect.high.y}};
    operator_tooltip(editor, *op, beside);
  }
  if (clicked) run(editor, *op);
}

void operator_box(Editor& editor, std::string_view id, const Rect& rect, const std::string& label) {
  const Operator& op = *find_operator(editor, id);
  const Look& look = editor.look;
  const bool can_run = disabled_reason(editor, op).empty(), on = op.checked(editor);
  const Pressed pressed = press_area(editor, label, rect, can_run);
  const float side = look.px(16), y = std::round(rect.centre().y - side / 2);
  checkbox_mark(editor, {{rect.low.x, y}, {rect.low.x + side, y + side}}, on, pressed.hovered && can_run);
  put_text(editor, look.fonts.regular, can_run ? look.theme.text : look.theme.text3,
           Rect{{rect.low.x + side + look.px(6), rect.low.y}, rect.high}, label);
  if (pressed.hovered) operator_tooltip(editor, op, rect);
  if (pressed.clicked) run(editor, op);
}

}  // namespace limber::editor
