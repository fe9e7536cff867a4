// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of edits, the oldest edit first. When the user clicks an edit or moves to it with the arrow keys, the
// project goes back (or forward) to its state after this edit.
#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {
constexpr char kList[] = "history";
}

void draw_history(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const History& history = context.history;
  if (column.begin_section("History", std::to_string(history.steps().size()), false)) {
    if (const std::string note = history.note(); !note.empty()) {
      const Rect rect = column.row(24);
      put_text(context.ui, look.fonts.small, look.theme.text2,
               Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.high.x - look.px(10), rect.high.y}}, note);
    }
    std::int64_t go_to = -1;
    const ListKey key = list_key(context.ui, kList, static_cast<int>(history.steps().size()));
    if (key == ListKey::Moved || key == ListKey::Activate) go_to = context.ui->list_focus.row;
    for (std::int64_t i = 0; i < std::ssize(history.steps()); ++i) {
      Rect rect;
      const bool current = i == history.position();
      if (!column.list_row(rect, static_cast<int>(i), current, kList)) continue;
      if (press_area(context.ui, "step " + std::to_string(i), rect).clicked) {
        go_to = i;
        focus_list(context.ui, kList, static_cast<int>(i));
      }
      const Colour colour = current ? look.theme.text : i < history.position() ? look.theme.text2 : look.theme.text3;
      put_text(context.ui, current ? look.fonts.semibold : look.fonts.regular, colour,
               Rect{{rect.low.x + look.px(14), rect.low.y}, {rect.high.x - look.px(10), rect.high.y}},
               history.steps()[i].label);
    }
    if (go_to >= 0) {
      context.history->jump(go_to);
      context.ui->touch();
    }
  }
  column.end_section();
}

}  // namespace limber::editor
