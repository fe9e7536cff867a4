// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_button.h"

#include <cctype>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/pointer_context.h"
#include "editor/input/keymap.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

std::string full_label(const Operator& op) {
  if (op.category != "Import" && op.category != "Export") return op.label;
  std::string words = op.label;
  // Abbreviations, such as "DICOM", keep their capitals.
  if (words.size() > 1 && std::islower(static_cast<unsigned char>(words[1])))
    words[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(words[0])));
  return op.category + " " + words;
}

void operator_tooltip(Context& context, const Operator& op, const Rect& rect) {
  const std::string reason = disabled_reason(context, op);
  tooltip(context.ui, rect, full_label(op), reason.empty() ? op.description : op.description + "\n" + reason,
          context.keymap->chord_of(op.id, contexts(context)));
}

bool operator_button(Context& context, std::string_view id, const Rect& rect, const std::string& label,
                     ButtonStyle style) {
  const Operator* op = find_operator(context.operators, id);
  if (!op) return false;
  const std::string reason = disabled_reason(context, *op);
  const bool clicked = button(context.ui, std::string(id), rect, {op->icon, label, style, reason.empty()});
  if (ImGui::IsItemHovered()) operator_tooltip(context, *op, rect);
  if (clicked) run(context, *op);
  return clicked;
}

void operator_menu_item(Context& context, std::string_view id, std::string_view submenu) {
  const Operator* op = find_operator(context.operators, id);
  if (!op) return;
  const std::string label = op->category == submenu ? op->label : full_label(*op);
  const auto chord = context.keymap->chord_of(op->id, contexts(context));
  const bool enabled = disabled_reason(context, *op).empty(), on = op->checked && op->checked(context);
  const Look& look = context.ui->look;
  const std::vector<std::string> caps = chord ? key_caps(*chord) : std::vector<std::string>{};
  const float least = std::max(look.px(190), text_size(look.fonts.regular, label).x + look.px(34 + 28) +
                                                 width_of_key_caps(context.ui, caps) + look.px(10));
  // Every row is as wide as the menu, so that it can be pressed at its right end, too.
  const float wide = std::max(least, ImGui::GetContentRegionAvail().x);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::PushID(op->id.c_str());
  const bool clicked =
      ImGui::Selectable("##item", false, enabled ? 0 : ImGuiSelectableFlags_Disabled, ImVec2(wide, look.px(22)));
  ImGui::PopID();
  const Rect rect{from_im(corner), {corner.x + wide, corner.y + look.px(22)}};
  register_widget(context.ui, label, rect, enabled);
  const Colour colour = enabled ? look.theme.text : look.theme.text3;
  put_icon(look.fonts.regular, enabled ? look.theme.text2 : look.theme.text3,
           Rect{{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}},
           on ? icon::kTick : op->icon);
  put_text(context.ui, look.fonts.regular, colour,
           Rect{{rect.low.x + look.px(34), rect.low.y}, {rect.high.x, rect.high.y}}, label);
  put_key_caps(context.ui, rect.high.x - look.px(8) - width_of_key_caps(context.ui, caps), rect.centre().y, caps);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
    const Rect beside{{rect.low.x, rect.low.y}, {rect.high.x, rect.high.y}};
    operator_tooltip(context, *op, beside);
  }
  if (clicked) run(context, *op);
}

void operator_box(Context& context, std::string_view id, const Rect& rect, const std::string& label) {
  const Operator& op = *find_operator(context.operators, id);
  const Look& look = context.ui->look;
  const bool can_run = disabled_reason(context, op).empty(), on = op.checked(context);
  const Pressed pressed = press_area(context.ui, label, rect, can_run);
  const float side = look.px(16), y = std::round(rect.centre().y - side / 2);
  checkbox_mark(context.ui, {{rect.low.x, y}, {rect.low.x + side, y + side}}, on, pressed.hovered && can_run);
  put_text(context.ui, look.fonts.regular, can_run ? look.theme.text : look.theme.text3,
           Rect{{rect.low.x + side + look.px(6), rect.low.y}, rect.high}, label);
  if (pressed.hovered) operator_tooltip(context, op, rect);
  if (pressed.clicked) run(context, op);
}

}  // namespace limber::editor
