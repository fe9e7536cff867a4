// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the console, which lists every message of this session, newest last. The user can filter messages by kind and
// text, and copy them.
#include "core/base/error.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/platform_window.h"
#include "editor/screen/console_state.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"
#include "editor/ui/severity_style.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "console";
constexpr Severity kSeverities[] = {Severity::Info, Severity::Ok, Severity::Warning, Severity::Error};
constexpr const char* kNames[] = {"Notes", "Done", "Warnings", "Errors"};

std::vector<const LogLine*> filtered(const Context& context) {
  std::vector<const LogLine*> lines;
  for (const LogLine& line : context.messages->log)
    if (!context.console->hidden[static_cast<std::size_t>(line.severity)] &&
        contains_ignoring_case(line.text, context.console->search))
      lines.push_back(&line);
  return lines;
}

void draw_head(Context& context, const Rect& head, const std::vector<const LogLine*>& lines) {
  const Look& look = context.ui->look;
  fill(head, look.theme.head);
  fill({head.low, {head.high.x, head.low.y + look.line()}}, look.theme.void_);
  const float top = head.low.y + look.px(3), bottom = head.high.y - look.px(3);
  float right = head.high.x - look.px(6);
  const Rect close{{right - look.px(24), top}, {right, bottom}};
  if (button(context.ui, "Close console", close, {icon::kClose, "", ButtonStyle::Flat})) run(context, "view.console");
  if (ImGui::IsItemHovered()) operator_tooltip(context, *find_operator(context.operators, "view.console"), close);
  right = close.low.x - look.px(4);
  const Rect copy{{right - look.px(28), top}, {right, bottom}};
  if (button(context.ui, "Copy console", copy, {icon::kCopy, "", ButtonStyle::Flat, !lines.empty()})) {
    std::string text;
    for (const LogLine* line : lines) text += line->text + "\n";
    context.host->set_clipboard(text);
  }
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    tooltip(context.ui, copy, "Copy", "Copy the visible messages to the clipboard.");
  right = copy.low.x - look.px(8);
  for (int i = 3; i >= 0; --i) {
    const auto severity = static_cast<std::size_t>(kSeverities[i]);
    const bool shown = !context.console->hidden[severity];
    const Rect place{{right - look.px(30), top}, {right, bottom}};
    const Pressed pressed = press_area(context.ui, kNames[i], place);
    if (pressed.hovered) fill(place, look.theme.hover, look.px(4));
    const auto [sign, colour] = sign_of(look.theme, kSeverities[i]);
    put_icon(look.fonts.regular, shown ? colour : look.theme.text3, place, shown ? sign : icon::kHidden);
    if (pressed.hovered)
      tooltip(context.ui, place, kNames[i],
              shown ? "Messages of this kind are shown. Click to hide them."
                    : "Messages of this kind are hidden. Click to show them.");
    if (pressed.clicked) context.console->hidden[severity] = shown;
    right = place.low.x - look.px(2);
  }
  const Rect search{{std::max(head.low.x + look.px(90), right - look.px(240)), top}, {right - look.px(6), bottom}};
  text_field(context.ui, "search", search, context.console->search, "Search messages");
  put_text(context.ui, look.fonts.semibold, look.theme.text,
           Rect{{head.low.x + look.px(12), head.low.y}, {search.low.x - look.px(6), head.high.y}}, "Console");
}

}  // namespace

void draw_console(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const std::vector<const LogLine*> lines = filtered(context);
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(28)}};
  draw_head(context, head, lines);
  Column column(context.ui, "lines", {{rect.low.x, head.high.y}, rect.high});
  if (lines.empty()) {
    const Rect row = column.row(28);
    put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{row.low.x + look.px(12), row.low.y}, row.high},
             context.messages->log.empty() ? "No messages yet" : "No message matches");
  }
  int index = 0;
  std::string shown_again;
  if (list_key(context.ui, kList, static_cast<int>(lines.size())) == ListKey::Activate && !lines.empty() &&
      lines[context.ui->list_focus.row]->severity == Severity::Error)
    shown_again = lines[context.ui->list_focus.row]->text;
  for (const LogLine* line : lines) {
    Rect row;
    if (!column.list_row(row, index++, false, kList)) continue;
    const auto [sign, colour] = sign_of(look.theme, line->severity);
    const Pressed pressed = press_area(context.ui, "line " + std::to_string(index), row);
    put_icon(look.fonts.regular, colour,
             Rect{{row.low.x + look.px(10), row.low.y}, {row.low.x + look.px(28), row.high.y}}, sign);
    put_text(context.ui, look.fonts.regular, look.theme.text,
             Rect{{row.low.x + look.px(36), row.low.y}, {row.high.x - look.px(10), row.high.y}}, line->text);
    if (pressed.clicked) focus_list(context.ui, kList, index - 1);
    if (pressed.right_clicked) context.host->set_clipboard(line->text);
    if (pressed.double_clicked && line->severity == Severity::Error) shown_again = line->text;
  }
  if (!shown_again.empty()) context.messages->show_again(shown_again);
  if (context.console->lines_seen != context.messages->log.size())
    ImGui::SetScrollHereY(1);  // scroll to the newest line
  context.console->lines_seen = context.messages->log.size();
}

}  // namespace limber::editor
