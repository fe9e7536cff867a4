// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the table of results below the views, one result per row. Beside it, draws the volume change of each tissue.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/resample/result_list.h"
#include "editor/resample/results.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/list_navigation.h"
#include "editor/volume/volume_change.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "results";
constexpr float kHead = 30, kTableHead = 26;
constexpr float kColumns[] = {60, 84, 70, 64};  // px: widths of the columns time, volume, overlap and inverted tets
constexpr float kState = 190, kNarrowState = 116, kNarrow = 640, kRoomy = 780;

// Draws the texts of a row: name, method, numbers, state. A narrow row omits the number of inverted tets.
void put_cells(Ui& ui, const Rect& row, const std::array<std::string, 7>& words, const std::array<Colour, 7>& colours,
               ImFont* first, ImFont* digits) {
  const Look& look = ui.look;
  float right = row.high.x - look.px(10);
  const float state = look.px(row.width() > look.px(kNarrow) ? kState : kNarrowState);
  put_text(ui, look.fonts.regular, colours[6], Rect{{right - state + look.px(14), row.low.y}, {right, row.high.y}},
           words[6]);
  right -= state;
  for (int i = row.width() > look.px(kRoomy) ? 5 : 4; i >= 2; --i) {
    const float width = look.px(kColumns[i - 2]);
    put_text(ui, digits, colours[i], Rect{{right - width, row.low.y}, {right, row.high.y}}, words[i], Align::Right);
    right -= width;
  }
  // Width of the method's name, px: enough for "FEM with contact", or in a narrow row for the start of this name.
  float method = look.px(row.width() > look.px(kNarrow) ? 124 : 56);
  // A name that is longer than its column takes the room that the method's name leaves free.
  const float name = row.low.x + look.px(34), gap = look.px(8);
  const float missing = text_size(first, words[0]).x + 1 - (right - method - gap - name);
  const float unused = method - text_size(look.fonts.regular, words[1]).x - gap;
  method -= std::max(0.0f, std::min(missing, unused));
  put_text(ui, look.fonts.regular, colours[1], Rect{{right - method, row.low.y}, {right, row.high.y}}, words[1]);
  put_text(ui, first, colours[0], Rect{{name, row.low.y}, {right - method - gap, row.high.y}}, words[0]);
}

std::string side_of(const Context& context, const std::shared_ptr<const Result>& result) {
  const Comparison& comparison = context.comparison;
  const bool a = result_named(context.document(), comparison.a) == result,
             b = result_named(context.document(), comparison.b) == result;
  if (a && b) return "";
  return a ? "A" : b ? "B" : "";
}

Colour colour_of_side(const Theme& theme, const std::string& side, bool shown) {
  return side == "A" ? kColourOfA : side == "B" ? kColourOfB : shown ? theme.accent_text : theme.text2;
}

std::string state_of(const std::string& side, bool shown) {
  return side + (shown ? std::string(side.empty() ? "" : ", ") + "shown" : "");
}

// Makes this result B of the comparison, or A if Shift is held.
void choose_side(Context& context, const std::string& name) {
  stop_watching(context.fem);
  Comparison& comparison = context.comparison;
  if (context.ui->input.modifiers().shift) {
    comparison.a = name;
  } else if (comparison.b == name && !comparison.shows_a && !comparing(context)) {
    show_rest(comparison);
  } else {
    comparison.b = comparison.b == name && !comparison.shows_a ? "" : name;
    comparison.shows_a = false;
  }
}

// Draws the result's name as a text field. Enter or a click elsewhere accepts the new name, Escape cancels.
void draw_renaming(Context& context, const Rect& row, const std::shared_ptr<const Result>& result) {
  const Look& look = context.ui->look;
  auto& renaming = context.results->renaming;
  const Rect field{{row.low.x + look.px(28), row.low.y + look.px(1)},
                   {row.low.x + std::min(look.px(320), row.width() * 0.6f), row.high.y - look.px(1)}};
  const bool entered = text_field(context.ui, "name", field, renaming.text, "", !std::exchange(renaming.focused, true));
  if (!ImGui::IsItemDeactivated()) return;
  const std::string name = std::exchange(renaming, {}).text;
  if (entered) rename_result(context, result, name);
}

void draw_rest_row(Context& context, Column& column, int index) {
  const Look& look = context.ui->look;
  const bool shown = !shown_result(context);
  Rect row;
  if (!column.list_row(row, index, shown, kList)) return;
  const PathScope path(context.ui, "At rest");
  const Pressed pressed = press_area(context.ui, "row", row);
  const std::string side = side_of(context, nullptr);
  put_icon(look.fonts.regular, colour_of_side(look.theme, side, shown),
           Rect{{row.low.x + look.px(10), row.low.y}, {row.low.x + look.px(28), row.high.y}}, icon::kVolume);
  const Colour plain = look.theme.text, second = look.theme.text2;
  put_cells(context.ui, row, {"At rest", "", "", "", "", "", state_of(side, shown)},
            {plain, second, second, second, second, second, second}, shown ? look.fonts.semibold : look.fonts.regular,
            look.fonts.mono);
  if (pressed.hovered)
    tooltip(context.ui, row, "At rest",
            "The volume at rest. Click to show it; Shift+click to make it side A of the comparison.");
  if (!pressed.clicked) return;
  focus_list(context.ui, kList, index);
  choose_side(context, "");
}

void draw_result_row(Context& context, Column& column, int index, const std::shared_ptr<const Result>& result,
                     bool& open_menu) {
  const Look& look = context.ui->look;
  const Theme& theme = look.theme;
  const bool shown = shown_result(context) == result;
  const std::string side = side_of(context, result);
  Rect row;
  if (!column.list_row(row, index, shown || !side.empty(), kList)) return;
  const PathScope path(context.ui, result->name);
  if (context.results->renaming.result == result->name) return draw_renaming(context, row, result);
  const Pressed pressed = press_area(context.ui, "row", row);
  const std::string reason = stale_reason(context.document(), *result);
  const auto facts = facts_of(context, result);
  put_icon(look.fonts.regular, !reason.empty() ? theme.warn : colour_of_side(theme, side, shown),
           Rect{{row.low.x + look.px(10), row.low.y}, {row.low.x + look.px(28), row.high.y}},
           reason.empty() ? icon::kResample : icon::kWaiting);
  char seconds[24];
  std::snprintf(seconds, sizeof seconds, "%.1f s", facts->seconds);
  const Colour plain = theme.text, second = theme.text2;
  // The cell shows only the beginning of the reason why the result is stale. The tooltip shows the whole reason.
  const std::string state =
      reason.empty() ? state_of(side, shown)
                     : (side.empty() ? "" : side + ", ") + "stale: " + reason.substr(0, reason.find(" changed"));
  put_cells(context.ui, row,
            {result->name, method_name(result->method), seconds, percent(facts->change_percent),
             grouped(facts->overlap_voxels), facts->inverted ? grouped(*facts->inverted) : "-", state},
            {plain, second, plain, colour_of_change(theme, facts->change_percent),
             facts->overlap_voxels ? theme.warn : theme.ok,
             !facts->inverted   ? second
             : *facts->inverted ? theme.error
                                : theme.ok,
             reason.empty() ? second : theme.warn},
            shown || !side.empty() ? look.fonts.semibold : look.fonts.regular, look.fonts.mono);
  if (pressed.hovered)
    tooltip(context.ui, row, result->name,
            std::string(shown ? "Shown now. Click to show the volume at rest."
                              : "Click to show this result in the views.") +
                " Shift+click to make it side A of the comparison; double-click to rename it." +
                (reason.empty() ? "" : "\nStale: " + reason));
  if (pressed.double_clicked) {
    context.comparison->b = result->name;
    context.results->renaming = {result->name, result->name};
    await_field(context.ui);
  } else if (pressed.clicked) {
    focus_list(context.ui, kList, index);
    choose_side(context, result->name);
  }
  if (pressed.right_clicked) {
    context.comparison->b = result->name;
    context.comparison->shows_a = false;
    open_menu = true;
  }
}

}  // namespace

void draw_results(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const auto results = context.document().results;  // a copy, because renaming a result replaces the document's list
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(kHead)}};
  fill(head, look.theme.head);
  fill({head.low, {head.high.x, head.low.y + look.line()}}, look.theme.void_);
  const float x =
      put_text(context.ui, look.fonts.semibold, look.theme.text,
               glm::vec2(head.low.x + look.px(12), head.centre().y - look.fonts.semibold->FontSize / 2), "Results");
  put_text(context.ui, look.fonts.regular, look.theme.text2,
           Rect{{x + look.px(8), head.low.y}, {x + look.px(60), head.high.y}}, std::to_string(results.size()));
  const float top = head.low.y + look.px(4), bottom = head.high.y - look.px(3);
  float right = head.high.x - look.px(8);
  for (const char* id : {"view.results", "result.delete", "result.rename", "result.copy_report", "compare.swap"}) {
    const bool closes = std::string_view(id) == "view.results";
    const Rect place{{right - look.px(26), top}, {right, bottom}};
    if (closes) {
      if (button(context.ui, "Close results", place, {icon::kClose, "", ButtonStyle::Flat})) run(context, id);
      if (ImGui::IsItemHovered()) operator_tooltip(context, *find_operator(context.operators, id), place);
    } else {
      operator_button(context, id, place, "", ButtonStyle::Flat);
    }
    right = place.low.x - look.px(4);
  }
  right -= look.px(6);
  for (const char* id : {"compare.show_b", "compare.show_a"}) {
    const Operator* op = find_operator(context.operators, id);
    const float width =
        // A pressed button has a wider label. Every button has the width that its pressed state needs, so that no
        // button moves when the user presses one.
        width_of_button(context.ui, {op->icon, op->label, ButtonStyle::Chosen});
    operator_button(context, id, {{right - width, top}, {right, bottom}}, op->label,
                    op->checked(context) ? ButtonStyle::Chosen : ButtonStyle::Plain);
    right -= width + look.px(1);
  }

  const Rect body{{rect.low.x, head.high.y}, rect.high};
  if (results.empty()) {
    const Operator* op = find_operator(context.operators, "resample.run");
    if (disabled_reason(context, *op).empty()) {
      if (empty_state(context.ui, body, "No results", "Resample this pose")) run(context, *op);
    } else {
      put_text(context.ui, look.fonts.regular, look.theme.text2, body, "No results. " + disabled_reason(context, *op),
               Align::Centre);
    }
    return;
  }
  const bool wide = body.width() > look.px(900);
  const float middle = wide ? body.high.x - look.px(430) : body.high.x;
  const Rect table_head{body.low, {middle, body.low.y + look.px(kTableHead)}};
  const Colour grey = look.theme.text2;
  // The titles leave room for the scroll bar, as the rows below do, so that each title stands above its column.
  const Rect heads{table_head.low, {table_head.high.x - ImGui::GetStyle().ScrollbarSize, table_head.high.y}};
  put_cells(context.ui, heads, {"Result", "Method", "Time", "Volume", "Overlap", "Inverted", "State"},
            {grey, grey, grey, grey, grey, grey, grey}, look.fonts.regular, look.fonts.regular);
  bool open_menu = false;
  {
    Column column(context.ui, "results", {{body.low.x, table_head.high.y}, {middle, body.high.y}});
    const ListKey key = list_key(context.ui, kList, static_cast<int>(results.size()) + 1);
    const auto row = static_cast<std::size_t>(context.ui->list_focus.row);
    const std::string name = row == 0 || row > results.size() ? "" : results[results.size() - row]->name;
    if (key == ListKey::Moved) show_result(context, name);
    if (key == ListKey::Activate) choose_side(context, name);
    if (key == ListKey::Rename && !name.empty()) {
      context.results->renaming = {name, name};
      await_field(context.ui);
    }
    int index = 0;
    draw_rest_row(context, column, index++);
    for (auto result = results.rbegin(); result != results.rend(); ++result)
      draw_result_row(context, column, index++, *result, open_menu);
  }
  if (open_menu) ImGui::OpenPopup("result menu");
  if (ImGui::BeginPopup("result menu", ImGuiWindowFlags_NoMove)) {
    context.ui->place.region = Region::Popup;
    push_path(context.ui, "result menu");
    put_text(context.ui, look.fonts.semibold, look.theme.text2,
             from_im(ImGui::GetCursorScreenPos()) + glm::vec2(look.px(8), look.px(2)),
             chosen_result(context) ? chosen_result(context)->name : "Result");
    ImGui::Dummy({look.px(190), look.px(22)});
    ImGui::Separator();
    for (const char* id : {"result.toggle", "compare.side_by_side", "compare.wipe", "compare.difference",
                           "result.overlap", "-", "report.open", "file.export", "result.copy_report", "-",
                           "result.rename", "result.delete", "result.delete_stale"})
      if (*id == '-') ImGui::Separator();
      else operator_menu_item(context, id);
    pop_path(context.ui);
    context.ui->place.region = Region::Bottom;
    ImGui::EndPopup();
  }
  if (!wide) return;
  fill({{middle, body.low.y}, {middle + look.line(), body.high.y}}, look.theme.void_);
  draw_change_plot(context, {{middle + look.line(), body.low.y}, body.high});
}

}  // namespace limber::editor
