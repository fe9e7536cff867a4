// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of tissues. Each row has an eye (a click shows or hides the tissue, Ctrl+click shows only this
// tissue), a colour, a name (a double click renames), a label and an opacity bar.
#include <algorithm>

#include "editor/context/panels.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

constexpr const char kList[] = "tissues";

std::string renamed_as(const Tissue& tissue) { return kList + std::to_string(tissue.label); }

void draw_eye(Editor& editor, const Rect& rect, const Tissue& tissue, const TissueLook& shown) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "eye", rect);
  put_icon(look.fonts.regular, shown.visible ? look.theme.text2 : look.theme.text3, rect,
           shown.visible ? icon::kVisible : icon::kHidden);
  if (pressed.hovered) tooltip(editor, rect, shown.visible ? "Hide" : "Show", "Ctrl+click to show only this tissue.");
  if (!pressed.clicked) return;
  if (editor.input.down(Key::Ctrl)) solo_tissues(editor, {tissue.label});
  else show_tissues(editor, {tissue.label}, !shown.visible);
}

// Draws a tissue's opacity bar. While the user drags it, the views show a preview; the end of the drag makes one edit.
void draw_opacity(Editor& editor, const Rect& rect, const Tissue& tissue, const TissueLook& shown) {
  const Look& look = editor.look;
  const Pressed pressed = press_area(editor, "opacity", rect);
  const bool released = ImGui::IsItemDeactivated();
  const Rect bar{{rect.low.x, rect.centre().y - look.px(3)}, {rect.high.x, rect.centre().y + look.px(3)}};
  const float share = std::clamp((editor.input.pointer.x - bar.low.x) / bar.width(), 0.0f, 1.0f);
  const float value = pressed.held ? share : shown.opacity;
  fill(bar, look.theme.field, look.px(3));
  fill({bar.low, {bar.low.x + bar.width() * value, bar.high.y}}, look.theme.text3, look.px(3));
  if (pressed.hovered)
    tooltip(editor, rect, "Opacity",
            std::to_string(static_cast<int>(value * 100 + 0.5f)) + " %. Used by the X-ray and tissue displays.");
  if (pressed.held) preview_look(editor, tissue.label, {shown.visible, share});
  if (released && editor.views->preview_visibility)
    set_look(editor, "Opacity of " + shown_name(tissue), tissue.label, {shown.visible, share});
}

void draw_row(Editor& editor, Column& column, int index, const Tissue& tissue) {
  const Look& look = editor.look;
  Rect rect;
  const bool chosen = editor.selection.tissues.contains(tissue.label),
             renaming = is_renaming(editor, renamed_as(tissue));
  if (renaming && !editor.renaming->shown) focus_list(editor, kList, index);
  if (!column.list_row(rect, index, chosen, kList)) return;
  const PathScope path(editor, tissue.name);
  const PathScope label_path(editor, std::to_string(tissue.label));
  const TissueLook shown = look_of(editor.document(), tissue.label);
  draw_eye(editor, {{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}}, tissue, shown);

  const float side = look.px(14), x = rect.low.x + look.px(30), y = std::round(rect.centre().y - side / 2);
  const Rect swatch{{x, y}, {x + side, y + side}};
  fill(swatch, rgb(tissue.colour.r, tissue.colour.g, tissue.colour.b), look.px(3));
  outline(swatch, look.theme.line2, look.px(3), look.line());

  const Rect name{{x + side, rect.low.y}, {rect.high.x - look.px(70), rect.high.y}};
  if (renaming) {
    std::string accepted = tissue.name;
    if (rename_field(
            editor,
            {{name.low.x + look.px(4), name.low.y + look.px(1)}, {name.high.x - look.px(4), name.high.y - look.px(1)}},
            accepted))
      rename_tissue(editor, tissue.label, accepted);
    return;
  }
  const Pressed pressed = press_area(editor, "name", name);
  const Colour colour = shown.visible ? look.theme.text : chosen ? look.theme.text2 : look.theme.text3;
  const std::string label = std::to_string(tissue.label);
  const float label_left = name.high.x - std::ceil(text_size(look.fonts.mono, label).x) - 1;
  put_text(editor, look.fonts.regular, colour,
           Rect{{name.low.x + look.px(6), name.low.y}, {label_left - look.px(6), name.high.y}}, shown_name(tissue));
  put_text(editor, look.fonts.mono, chosen ? look.theme.text2 : look.theme.text3,
           Rect{{label_left, name.low.y}, name.high}, label, Align::Right);
  if (pressed.clicked) {
    focus_list(editor, kList, index);
    select_tissue(editor, tissue.label, editor.input.down(Key::Ctrl) || editor.input.down(Key::Shift));
  }
  if (pressed.double_clicked) begin_renaming(editor, renamed_as(tissue), tissue.name);
  if (pressed.right_clicked) {
    if (!chosen) select_tissue(editor, tissue.label, false);
    editor.open_popup = "Tissue";
  }
  draw_opacity(editor, {{rect.high.x - look.px(64), rect.low.y}, {rect.high.x - look.px(8), rect.high.y}}, tissue,
               shown);
}

void take_key(Editor& editor, const std::vector<const Tissue*>& rows) {
  const ListKey key = list_key(editor, kList, static_cast<int>(rows.size()));
  if (key == ListKey::None || rows.empty()) return;
  const Tissue& tissue = *rows[editor.list_focus.row];
  if (key == ListKey::Moved || key == ListKey::Activate) select_tissue(editor, tissue.label, false);
  if (key == ListKey::Rename) begin_renaming(editor, renamed_as(tissue), tissue.name);
  if (key == ListKey::Toggle) show_tissues(editor, {tissue.label}, !look_of(editor.document(), tissue.label).visible);
}

// Returns the tissues that match the search text: their name contains it, or their label is equal to it.
std::vector<const Tissue*> found(const Editor& editor, const TissueTable& tissues) {
  std::vector<const Tissue*> rows;
  for (const Tissue& tissue : tissues.tissues)
    if (contains_ignoring_case(shown_name(tissue), editor.tissue_search) ||
        contains_ignoring_case(tissue.name, editor.tissue_search) ||
        std::to_string(tissue.label) == editor.tissue_search)
      rows.push_back(&tissue);
  return rows;
}

}  // namespace

void draw_tissues(Editor& editor, Column& column) {
  const Look& look = editor.look;
  const auto tissues = editor.document().tissues;  // copied, since drawing a row may change the document
  const std::string count = tissues ? std::to_string(tissues->tissues.size()) : "";
  if (column.begin_section("Tissues", count)) {
    if (!tissues) {
      const Rect rect = column.row(30);
      put_text(editor, look.fonts.regular, look.theme.text2, Rect{{rect.low.x + look.px(14), rect.low.y}, rect.high},
               "Open a volume to see its tissues");
    } else {
      if (tissues->tissues.size() > 16) {
        const Rect rect = column.row(32);
        text_field(editor, "search",
                   {rect.low + glm::vec2(look.px(10), look.px(4)), rect.high - glm::vec2(look.px(10), look.px(4))},
                   editor.tissue_search, "Search tissues");
      }
      const std::vector<const Tissue*> rows = found(editor, *tissues);
      take_key(editor, rows);
      for (int i = 0; i < std::ssize(rows); ++i) draw_row(editor, column, i, *rows[i]);
      if (tissues->tissues.empty()) {
        const Rect rect = column.row(30);
        put_text(editor, look.fonts.regular, look.theme.text2, Rect{{rect.low.x + look.px(14), rect.low.y}, rect.high},
                 editor.views->image ? "No labels yet" : "No tissue: the volume is all air");
      } else if (rows.empty() &&
                 empty_state(editor, column.row(72), "No tissue named '" + editor.tissue_search + "'", "Clear search"))
        editor.tissue_search.clear();
    }
  }
  column.end_section();
}

}  // namespace limber::editor
