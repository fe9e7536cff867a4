// SPDX-License-Identifier: AGPL-3.0-or-later
// The area below the views: the console, every message of this session.
#include "editor/icons.h"
#include "editor/panels/panels.h"

namespace limber::editor {

namespace {

std::pair<const char*, Colour> sign_of(const Theme& theme, Severity severity) {
  switch (severity) {
    case Severity::Info: return {icon::kInfo, theme.accent_text};
    case Severity::Ok: return {icon::kOk, theme.ok};
    case Severity::Warning: return {icon::kWarning, theme.warn};
    case Severity::Error: break;
  }
  return {icon::kError, theme.error};
}

}  // namespace

void draw_bottom(Editor& editor) {
  const Rect& rect = editor.layout.bottom;
  if (rect.empty()) return;
  const Look& look = editor.look;
  begin_region(editor, Region::Bottom, "bottom", rect, look.theme.panel);
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(28)}};
  fill(head, look.theme.head);
  fill({head.low, {head.high.x, head.low.y + look.line()}}, look.theme.void_);
  put_text(editor, look.fonts.semibold, look.theme.text, Rect{{head.low.x + look.px(12), head.low.y}, head.high}, "Console");
  const Rect close{{head.high.x - look.px(28), head.low.y + look.px(4)}, {head.high.x - look.px(6), head.high.y - look.px(2)}};
  if (button(editor, "Close console", close, {icon::kClose, "", ButtonStyle::Flat})) editor.arrangement().console = false;
  {
    Column column(editor, "lines", {{rect.low.x, head.high.y}, rect.high});
    int index = 0;
    if (editor.messages.log.empty()) {
      const Rect row = column.row(28);
      put_text(editor, look.fonts.regular, look.theme.text2, Rect{{row.low.x + look.px(12), row.low.y}, row.high}, "No messages yet");
    }
    for (const LogLine& line : editor.messages.log) {
      Rect row;
      if (!column.list_row(row, index++, false)) continue;
      const auto [sign, colour] = sign_of(look.theme, line.severity);
      put_icon(look.fonts.regular, colour, Rect{{row.low.x + look.px(10), row.low.y}, {row.low.x + look.px(28), row.high.y}}, sign);
      put_text(editor, look.fonts.regular, look.theme.text, Rect{{row.low.x + look.px(36), row.low.y}, {row.high.x - look.px(10), row.high.y}}, line.text);
    }
  }
  end_region(editor);
}

}  // namespace limber::editor
