// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the settings of the last operation, so that the user can adjust them afterwards. The settings are drawn in a
// box that unfolds in the view, or in a form that opens at the pointer.
#include <utility>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/views.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/ui/icons.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 232, kHead = 26, kRow = 30, kLabel = 62, kMargin = 12;

float height_of(const LastOperation& last) { return kHead + kRow * static_cast<float>(last.fields.size()) + 6; }

void draw_fields(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  float y = rect.low.y;
  bool changed = false;
  for (FormField& field : context.last_operation->shown) {
    changed |=
        draw_field(context, field, {{rect.low.x + look.px(10), y}, {rect.high.x - look.px(10), y + look.px(kRow)}},
                   look.px(kLabel));
    y += look.px(kRow);
  }
  if (changed) redo_last_operator(context, std::vector(context.last_operation->shown));
}

}  // namespace

void draw_last_operation(Context& context, const Rect& view) {
  LastOperation& last = *context.last_operation;
  const Look& look = context.ui->look;
  const float height = last.unfolded ? height_of(last) : kHead;
  if (!why_not_redo(context).empty() || view.width() < look.px(kWidth + 240) || view.height() < look.px(height + 120))
    return;
  const PathScope path(context.ui, "last operation");
  const glm::vec2 low{view.low.x + look.px(kMargin), view.high.y - look.px(kMargin + height)};
  const Rect box{low, low + glm::vec2(look.px(kWidth), look.px(height))};
  fill(box, with_alpha(look.theme.panel, 0.94f), look.px(5));
  outline(box, look.theme.line2, look.px(5), look.line());
  const Rect head{box.low, {box.high.x, box.low.y + look.px(kHead)}};
  const Pressed pressed = press_area(context.ui, "fold", head);
  put_icon(look.fonts.regular, look.theme.text2, Rect{head.low, {head.low.x + look.px(26), head.high.y}},
           last.unfolded ? icon::kOpened : icon::kClosed);
  put_text(context.ui, look.fonts.regular, pressed.hovered ? look.theme.text : look.theme.text2,
           Rect{{head.low.x + look.px(26), head.low.y}, {head.high.x - look.px(8), head.high.y}}, last.label);
  if (pressed.hovered) operator_tooltip(context, *find_operator(context.operators, "edit.adjust_last"), head);
  register_widget(context.ui, "box", box);
  if (last.unfolded) draw_fields(context, {{box.low.x, head.high.y}, box.high});
  if (pressed.clicked) last.unfolded = !last.unfolded;
}

void draw_last_operation_popup(Context& context) {
  LastOperation& last = *context.last_operation;
  if (std::exchange(last.wanted_at_pointer, false)) ImGui::OpenPopup("adjust last");
  const Look& look = context.ui->look;
  const glm::vec2 size{look.px(kWidth + 20), look.px(height_of(last))};
  ImGui::SetNextWindowSize(im(size + 2.0f * from_im(ImGui::GetStyle().WindowPadding)));
  if (!ImGui::BeginPopup("adjust last", ImGuiWindowFlags_NoMove)) return;
  context.ui->place.region = Region::Popup;
  push_path(context.ui, "adjust");
  const glm::vec2 low = from_im(ImGui::GetCursorScreenPos());
  const Rect box{low, low + size};
  if (why_not_redo(context).empty()) {
    put_text(context.ui, look.fonts.semibold, look.theme.text,
             Rect{{box.low.x + look.px(10), box.low.y}, {box.high.x - look.px(10), box.low.y + look.px(kHead)}},
             last.label);
    draw_fields(context, {{box.low.x, box.low.y + look.px(kHead)}, box.high});
  } else {
    ImGui::CloseCurrentPopup();
  }
  pop_path(context.ui);
  context.ui->place.region = Region::Views;
  ImGui::EndPopup();
}

}  // namespace limber::editor
