// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of bones that can have weights. A row shows the bone's colour, its name, its share of the body's total
// weight, a lock, and an eye. The eye hides the bone's region, which is the tissue where the bone has the largest
// weight; Ctrl+click on the eye shows only this region.
#include <algorithm>
#include <cmath>
#include <utility>

#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/selection.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "bones";
constexpr int kMostRows = 8;  // number of rows of the list that are visible without scrolling
// Widths of the parts of a row, pixels at scale 1. kShareBar is the bar that shows the bone's share of the total
// weight. In a narrow sidebar, this bar shrinks to kShortestBar before the name becomes narrower than kName.
constexpr float kShareBar = 64, kShortestBar = 24, kName = 112;
constexpr float kRightOfBar = 95, kLeftOfName = 28;

float bar_width(const Look& look, const Rect& row) {
  return std::clamp(row.width() - look.px(kLeftOfName + kName + 8 + kRightOfBar), look.px(kShortestBar),
                    look.px(kShareBar));
}

void draw_share(Ui& ui, const Rect& rect, bool active, const std::optional<double>& share) {
  const Look& look = ui.look;
  const float right = rect.high.x - look.px(kRightOfBar), middle = rect.centre().y;
  const Rect bar{{right - bar_width(look, rect), middle - look.px(3)}, {right, middle + look.px(3)}};
  fill(bar, look.theme.field, look.px(3));
  if (!share) return;
  if (*share > 0)
    fill({bar.low, {bar.low.x + std::max(look.px(2), bar.width() * static_cast<float>(*share)), bar.high.y}},
         active ? look.theme.select : look.theme.text3, look.px(3));
  const int percent = static_cast<int>(std::lround(*share * 100));
  const std::string text = percent == 0 && *share > 0 ? "<1 %" : std::to_string(percent) + " %";
  put_text(ui, look.fonts.mono, look.theme.text2,
           Rect{{bar.high.x, rect.low.y}, {rect.high.x - look.px(53), rect.high.y}}, text, Align::Right);
}

void draw_lock(Context& context, const Rect& rect, int bone, const std::string& name) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "lock", rect);
  const bool locked = is_locked(context.document(), name);
  put_icon(look.fonts.regular,
           locked            ? look.theme.warn
           : pressed.hovered ? look.theme.text
                             : look.theme.text3,
           rect, locked ? icon::kLock : icon::kUnlocked);
  if (pressed.hovered)
    tooltip(context.ui, rect, locked ? "Unlock" : "Lock",
            "The weights of a locked bone cannot change. Ctrl+click locks all bones except this one.");
  if (!pressed.clicked) return;
  if (context.ui->input.down(Key::Ctrl)) lock_all_but(context, bone);
  else toggle_lock(context, bone);
}

void draw_eye(Context& context, const Rect& rect, const std::string& name) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "eye", rect);
  const bool hidden = context.skin->hidden.contains(name);
  put_icon(look.fonts.regular, hidden ? look.theme.text3 : look.theme.text2, rect,
           hidden ? icon::kHidden : icon::kVisible);
  if (pressed.hovered)
    tooltip(context.ui, rect, hidden ? "Show region" : "Hide region",
            "The region is the tissue where this bone has the largest weight. Ctrl+click shows only this region.");
  if (!pressed.clicked) return;
  if (context.ui->input.down(Key::Ctrl)) isolate_regions(context, {name});
  else hide_region(context, name, !hidden);
}

void choose(Context& context, int bone, bool extended) {
  Selection& selection = context.selection;
  // Only the bones are deselected. The selected tissues stay selected, because brushes may be limited to them.
  if (!extended) selection.bones.clear();
  selection.bone = bone;
  selection.bones.insert(bone);
  context.skin->revealed = bone;
}

void draw_row(Context& context, Column& column, int index, int bone) {
  const Look& look = context.ui->look;
  const std::string name = context.document().armature->bones[static_cast<std::size_t>(bone)].name;
  const bool active = skin_bone(context) == bone, chosen = active || context.selection->bones.contains(bone);
  Rect rect;
  if (!column.list_row(rect, index, chosen, kList)) return;
  const PathScope path(context.ui, name);
  const Rect press{rect.low, {rect.high.x - look.px(54), rect.high.y}};
  const Pressed pressed = press_area(context.ui, "name", press);
  const glm::vec2 corner{rect.low.x + look.px(8), std::round(rect.centre().y - look.px(7))};
  fill({corner, corner + look.px(14)}, swatch_of(context, bone), look.px(3));
  const auto weights = seen_weights(context);
  const auto share = weights ? context.skin->shares.of(weights_bone(*weights, name)) : std::nullopt;
  put_text(context.ui, active ? look.fonts.semibold : look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(kLeftOfName), rect.low.y},
                {rect.high.x - look.px(kRightOfBar + 6) - bar_width(look, rect), rect.high.y}},
           name);
  draw_share(context.ui, rect, active, share);
  draw_lock(context, {{rect.high.x - look.px(50), rect.low.y}, {rect.high.x - look.px(30), rect.high.y}}, bone, name);
  draw_eye(context, {{rect.high.x - look.px(28), rect.low.y}, {rect.high.x - look.px(8), rect.high.y}}, name);
  if (pressed.clicked) {
    focus_list(context.ui, kList, index);
    choose(context, bone, context.ui->input.down(Key::Ctrl) || context.ui->input.down(Key::Shift));
  }
  if (pressed.right_clicked) {
    if (!context.selection->bones.contains(bone)) choose(context, bone, false);
    context.menus->open_popup = "Bone weights";
  }
}

std::vector<int> found(const Context& context) {
  std::vector<int> rows;
  const auto& bones = context.document().armature->bones;
  for (int bone = 0; bone < std::ssize(bones); ++bone)
    if (!context.skin->searching ||
        contains_ignoring_case(bones[static_cast<std::size_t>(bone)].name, context.skin->search))
      rows.push_back(bone);
  return rows;
}

void take_key(Context& context, const std::vector<int>& rows) {
  const ListKey key = list_key(context.ui, kList, static_cast<int>(rows.size()));
  if (key == ListKey::None || rows.empty()) return;
  const int bone = rows[static_cast<std::size_t>(context.ui->list_focus.row)];
  const std::string& name = context.document().armature->bones[static_cast<std::size_t>(bone)].name;
  if (key == ListKey::Moved || key == ListKey::Activate) choose(context, bone, false);
  if (key == ListKey::Toggle) hide_region(context, name, !context.skin->hidden.contains(name));
}

void draw_rows(Context& context, Column& column, const std::vector<int>& rows) {
  for (int i = 0; i < std::ssize(rows); ++i) draw_row(context, column, i, rows[static_cast<std::size_t>(i)]);
}

// Scrolls the list to the active bone after the user picked this bone in a view.
void reveal_active(Context& context, const std::vector<int>& rows) {
  const auto active = skin_bone(context);
  if (context.skin->revealed == active) return;
  context.skin->revealed = active;
  const auto row = std::find(rows.begin(), rows.end(), active.value_or(-1));
  if (row == rows.end()) return;
  const float height = context.ui->look.px(24), at = height * static_cast<float>(row - rows.begin()),
              top = ImGui::GetScrollY();
  if (at < top) ImGui::SetScrollY(at);
  if (at + height > top + kMostRows * height) ImGui::SetScrollY(at - (kMostRows - 1) * height);
  context.ui->touch();
}

void draw_list(Context& context, Column& column) {
  const std::vector<int> rows = found(context);
  take_key(context, rows);
  if (rows.empty()) {
    if (empty_state(context.ui, column.row(72), "No bone named '" + context.skin->search + "'", "Clear search"))
      context.skin->search.clear();
  } else if (std::ssize(rows) <= kMostRows) {
    draw_rows(context, column, rows);
  } else {
    Column list(context.ui, "list", column.row(24 * kMostRows));
    reveal_active(context, rows);
    draw_rows(context, list, rows);
  }
}

void draw_foot(Context& context, Column& column, std::size_t count) {
  const Look& look = context.ui->look;
  const Rect rect = column.row(38);
  const Operator* op = find_operator(context.operators, "skin.lock_others");
  const float width = width_of_button(context.ui, {op->icon, op->label});
  const glm::vec2 corner{rect.low.x + look.px(10), rect.low.y + look.px(6)};
  operator_button(context, op->id, {corner, corner + glm::vec2(width, look.px(26))}, op->label);
  put_text(context.ui, look.fonts.small, look.theme.text3,
           Rect{{corner.x + width + look.px(8), corner.y}, {rect.high.x - look.px(10), corner.y + look.px(26)}},
           std::to_string(count) + (count == 1 ? " bone" : " bones"), Align::Right);
}

void draw_search_icon(Context& context, const Rect& head) {
  const Look& look = context.ui->look;
  const Rect rect{{head.high.x - look.px(30), head.low.y}, {head.high.x - look.px(8), head.high.y}};
  const Pressed pressed = press_area(context.ui, "search bones", rect);
  put_icon(look.fonts.regular, context.skin->searching || pressed.hovered ? look.theme.text : look.theme.text2, rect,
           icon::kSearch);
  if (pressed.hovered) operator_tooltip(context, *find_operator(context.operators, "skin.find_bone"), rect);
  if (!pressed.clicked) return;
  if (context.skin->searching) context.skin->searching = false;
  else run(context, "skin.find_bone");
}

}  // namespace

void draw_bones(Context& context, Column& column) {
  const auto armature = context.document().armature;  // a copy, because a row may commit an edit that replaces it
  const bool open = column.begin_section("Bones");
  if (armature) draw_search_icon(context, column.head());
  if (open && !armature) {
    if (empty_state(context.ui, column.row(72), "No rig yet", find_operator(context.operators, "rig.auto_fit")->label))
      run(context, "rig.auto_fit");
  } else if (open && !context.document().weights) {
    if (empty_state(context.ui, column.row(72), "No weights yet", find_operator(context.operators, "skin.heat")->label))
      run(context, "skin.heat");
  } else if (open) {
    if (context.skin->searching) {
      const Rect rect = column.row(32);
      text_field(context.ui, "search",
                 {rect.low + glm::vec2(context.ui->look.px(10), context.ui->look.px(4)),
                  rect.high - glm::vec2(context.ui->look.px(10), context.ui->look.px(4))},
                 context.skin->search, "Search bones", std::exchange(context.skin->focus_search, false));
    }
    draw_list(context, column);
    draw_foot(context, column, armature->bones.size());
  }
  column.end_section();
}

}  // namespace limber::editor
