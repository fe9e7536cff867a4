// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of bones that can have weights. A row shows the bone's colour, its name, its share of the body's total
// weight, a lock, and an eye. The eye hides the bone's region, which is the tissue where the bone has the largest
// weight; Ctrl+click on the eye shows only this region.
#include <algorithm>
#include <cmath>
#include <utility>

#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
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

void draw_share(Editor& editor, const Rect& rect, bool active, const std::optional<double>& share) {
  const Look& look = editor.look;
  const float right = rect.high.x - look.px(kRightOfBar), middle = rect.centre().y;
  const Rect bar{{right - bar_width(look, rect), middle - look.px(3)}, {right, middle + look.px(3)}};
  fill(bar, look.theme.field, look.px(3));
  if (!share) return;
  if (*share > 0)
    fill({bar.low, {bar.low.x + std::max(look.px(2), bar.width() * static_cast<float>(*share)), bar.high.y}},
         active ? look.theme.select : look.theme.text3, look.px(3));
  const int percent = static_cast<int>(std::lround(*share * 100));
  const std::string text = percent == 0 && *share > 0 ? "<1 %" : std::to_string(percent) + " %";
  put_text(editor, look.fonts.mono, look.theme.text2,
           Rect{{bar.high.x, rect.low.y}, {rect.high.x - look.px(53), rect.high.y}}, text, Align::Right);
}

void draw_lock(Editor& editor, const Rect& rect, int bone, const std::string& name) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "lock", rect);
  const bool locked = is_locked(editor.document(), name);
  put_icon(look.fonts.regular,
           locked            ? look.theme.warn
           : pressed.hovered ? look.theme.text
                             : look.theme.text3,
           rect, locked ? icon::kLock : icon::kUnlocked);
  if (pressed.hovered)
    tooltip(editor, rect, locked ? "Unlock" : "Lock",
            "The weights of a locked bone cannot change. Ctrl+click locks all bones except this one.");
  if (!pressed.clicked) return;
  if (editor.input.down(Key::Ctrl)) lock_all_but(editor, bone);
  else toggle_lock(editor, bone);
}

void draw_eye(Editor& editor, const Rect& rect, const std::string& name) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "eye", rect);
  const bool hidden = editor.skin->hidden.contains(name);
  put_icon(look.fonts.regular, hidden ? look.theme.text3 : look.theme.text2, rect,
           hidden ? icon::kHidden : icon::kVisible);
  if (pressed.hovered)
    tooltip(editor, rect, hidden ? "Show region" : "Hide region",
            "The region is the tissue where this bone has the largest weight. Ctrl+click shows only this region.");
  if (!pressed.clicked) return;
  if (editor.input.down(Key::Ctrl)) isolate_regions(editor, {name});
  else hide_region(editor, name, !hidden);
}

void choose(Editor& editor, int bone, bool extended) {
  Selection& selection = editor.selection;
  // Only the bones are deselected. The selected tissues stay selected, because brushes may be limited to them.
  if (!extended) selection.bones.clear();
  selection.bone = bone;
  selection.bones.insert(bone);
  editor.skin->revealed = bone;
}

void draw_row(Editor& editor, Column& column, int index, int bone) {
  const Look& look = editor.look;
  const std::string name = editor.document().armature->bones[static_cast<std::size_t>(bone)].name;
  const bool active = skin_bone(editor) == bone, chosen = active || editor.selection.bones.contains(bone);
  Rect rect;
  if (!column.list_row(rect, index, chosen, kList)) return;
  const PathScope path(editor, name);
  const Rect press{rect.low, {rect.high.x - look.px(54), rect.high.y}};
  const Pressed pressed = press_area(editor, "name", press);
  const glm::vec2 corner{rect.low.x + look.px(8), std::round(rect.centre().y - look.px(7))};
  fill({corner, corner + look.px(14)}, swatch_of(editor, bone), look.px(3));
  const auto weights = seen_weights(editor);
  const auto share = weights ? editor.skin->shares.of(weights_bone(*weights, name)) : std::nullopt;
  put_text(editor, active ? look.fonts.semibold : look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(kLeftOfName), rect.low.y},
                {rect.high.x - look.px(kRightOfBar + 6) - bar_width(look, rect), rect.high.y}},
           name);
  draw_share(editor, rect, active, share);
  draw_lock(editor, {{rect.high.x - look.px(50), rect.low.y}, {rect.high.x - look.px(30), rect.high.y}}, bone, name);
  draw_eye(editor, {{rect.high.x - look.px(28), rect.low.y}, {rect.high.x - look.px(8), rect.high.y}}, name);
  if (pressed.clicked) {
    focus_list(editor, kList, index);
    choose(editor, bone, editor.input.down(Key::Ctrl) || editor.input.down(Key::Shift));
  }
  if (pressed.right_clicked) {
    if (!editor.selection.bones.contains(bone)) choose(editor, bone, false);
    editor.open_popup = "Bone weights";
  }
}

std::vector<int> found(const Editor& editor) {
  std::vector<int> rows;
  const auto& bones = editor.document().armature->bones;
  for (int bone = 0; bone < std::ssize(bones); ++bone)
    if (!editor.skin->searching ||
        contains_ignoring_case(bones[static_cast<std::size_t>(bone)].name, editor.skin->search))
      rows.push_back(bone);
  return rows;
}

void take_key(Editor& editor, const std::vector<int>& rows) {
  const ListKey key = list_key(editor, kList, static_cast<int>(rows.size()));
  if (key == ListKey::None || rows.empty()) return;
  const int bone = rows[static_cast<std::size_t>(editor.list_focus.row)];
  const std::string& name = editor.document().armature->bones[static_cast<std::size_t>(bone)].name;
  if (key == ListKey::Moved || key == ListKey::Activate) choose(editor, bone, false);
  if (key == ListKey::Toggle) hide_region(editor, name, !editor.skin->hidden.contains(name));
}

void draw_rows(Editor& editor, Column& column, const std::vector<int>& rows) {
  for (int i = 0; i < std::ssize(rows); ++i) draw_row(editor, column, i, rows[static_cast<std::size_t>(i)]);
}

// Scrolls the list to the active bone after the user picked this bone in a view.
void reveal_active(Editor& editor, const std::vector<int>& rows) {
  const auto active = skin_bone(editor);
  if (editor.skin->revealed == active) return;
  editor.skin->revealed = active;
  const auto row = std::find(rows.begin(), rows.end(), active.value_or(-1));
  if (row == rows.end()) return;
  const float height = editor.look.px(24), at = height * static_cast<float>(row - rows.begin()),
              top = ImGui::GetScrollY();
  if (at < top) ImGui::SetScrollY(at);
  if (at + height > top + kMostRows * height) ImGui::SetScrollY(at - (kMostRows - 1) * height);
  editor.touch();
}

void draw_list(Editor& editor, Column& column) {
  const std::vector<int> rows = found(editor);
  take_key(editor, rows);
  if (rows.empty()) {
    if (empty_state(editor, column.row(72), "No bone named '" + editor.skin->search + "'", "Clear search"))
      editor.skin->search.clear();
  } else if (std::ssize(rows) <= kMostRows) {
    draw_rows(editor, column, rows);
  } else {
    Column list(editor, "list", column.row(24 * kMostRows));
    reveal_active(editor, rows);
    draw_rows(editor, list, rows);
  }
}

void draw_foot(Editor& editor, Column& column, std::size_t count) {
  const Look& look = editor.look;
  const Rect rect = column.row(38);
  const Operator* op = find_operator(editor, "skin.lock_others");
  const float width = width_of_button(editor, {op->icon, op->label});
  const glm::vec2 corner{rect.low.x + look.px(10), rect.low.y + look.px(6)};
  operator_button(editor, op->id, {corner, corner + glm::vec2(width, look.px(26))}, op->label);
  put_text(editor, look.fonts.small, look.theme.text3,
           Rect{{corner.x + width + look.px(8), corner.y}, {rect.high.x - look.px(10), corner.y + look.px(26)}},
           std::to_string(count) + (count == 1 ? " bone" : " bones"), Align::Right);
}

void draw_search_icon(Editor& editor, const Rect& head) {
  const Look& look = editor.look;
  const Rect rect{{head.high.x - look.px(30), head.low.y}, {head.high.x - look.px(8), head.high.y}};
  const Pressed pressed = press_area(editor, "search bones", rect);
  put_icon(look.fonts.regular, editor.skin->searching || pressed.hovered ? look.theme.text : look.theme.text2, rect,
           icon::kSearch);
  if (pressed.hovered) operator_tooltip(editor, *find_operator(editor, "skin.find_bone"), rect);
  if (!pressed.clicked) return;
  if (editor.skin->searching) editor.skin->searching = false;
  else run(editor, "skin.find_bone");
}

}  // namespace

void draw_bones(Editor& editor, Column& column) {
  const auto armature = editor.document().armature;  // a copy, because a row may commit an edit that replaces it
  const bool open = column.begin_section("Bones");
  if (armature) draw_search_icon(editor, column.head());
  if (open && !armature) {
    if (empty_state(editor, column.row(72), "No skeleton yet", find_operator(editor, "rig.auto_fit")->label))
      run(editor, "rig.auto_fit");
  } else if (open && !editor.document().weights) {
    if (empty_state(editor, column.row(72), "No weights yet", find_operator(editor, "skin.heat")->label))
      run(editor, "skin.heat");
  } else if (open) {
    if (editor.skin->searching) {
      const Rect rect = column.row(32);
      text_field(editor, "search",
                 {rect.low + glm::vec2(editor.look.px(10), editor.look.px(4)),
                  rect.high - glm::vec2(editor.look.px(10), editor.look.px(4))},
                 editor.skin->search, "Search bones", std::exchange(editor.skin->focus_search, false));
    }
    draw_list(editor, column);
    draw_foot(editor, column, armature->bones.size());
  }
  column.end_section();
}

}  // namespace limber::editor
