// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of tissues. Each row has an eye (a click shows or hides the tissue, Ctrl+click shows only this
// tissue), a colour, a name (a double click renames), a label and an opacity bar.
#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/outliner_state.h"
#include "editor/context/panels.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

constexpr const char kList[] = "tissues";

std::string renamed_as(const Tissue& tissue) { return kList + std::to_string(tissue.label); }

void draw_eye(Context& context, const Rect& rect, const Tissue& tissue, const TissueLook& shown) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "eye", rect);
  put_icon(look.fonts.regular, shown.visible ? look.theme.text2 : look.theme.text3, rect,
           shown.visible ? icon::kVisible : icon::kHidden);
  if (pressed.hovered)
    tooltip(context.ui, rect, shown.visible ? "Hide" : "Show", "Ctrl+click to show only this tissue.");
  if (!pressed.clicked) return;
  if (context.ui->input.down(Key::Ctrl)) solo_tissues(context, {tissue.label});
  else show_tissues(context, {tissue.label}, !shown.visible);
}

// Draws a tissue's opacity bar. While the user drags it, the views show a preview; the end of the drag makes one edit.
void draw_opacity(Context& context, const Rect& rect, const Tissue& tissue, const TissueLook& shown) {
  const Look& look = context.ui->look;
  const Pressed pressed = press_area(context.ui, "opacity", rect);
  const bool released = ImGui::IsItemDeactivated();
  const Rect bar{{rect.low.x, rect.centre().y - look.px(3)}, {rect.high.x, rect.centre().y + look.px(3)}};
  const float share = std::clamp((context.ui->input.pointer.x - bar.low.x) / bar.width(), 0.0f, 1.0f);
  const float value = pressed.held ? share : shown.opacity;
  fill(bar, look.theme.field, look.px(3));
  fill({bar.low, {bar.low.x + bar.width() * value, bar.high.y}}, look.theme.text3, look.px(3));
  if (pressed.hovered)
    tooltip(context.ui, rect, "Opacity",
            std::to_string(static_cast<int>(value * 100 + 0.5f)) + " %. Used by the X-ray and tissue displays.");
  if (pressed.held) preview_look(context, tissue.label, {shown.visible, share});
  if (released && context.views->preview_visibility)
    set_look(context, "Set opacity of " + shown_name(tissue), tissue.label, {shown.visible, share});
}

void draw_row(Context& context, Column& column, int index, const Tissue& tissue) {
  const Look& look = context.ui->look;
  Rect rect;
  const bool chosen = context.selection->tissues.contains(tissue.label),
             renaming = is_renaming(context.ui, renamed_as(tissue));
  if (renaming && !context.ui->renaming->shown) focus_list(context.ui, kList, index);
  if (!column.list_row(rect, index, chosen, kList)) return;
  const PathScope path(context.ui, tissue.name);
  const PathScope label_path(context.ui, std::to_string(tissue.label));
  const TissueLook shown = look_of(context.document(), tissue.label);
  draw_eye(context, {{rect.low.x + look.px(6), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}}, tissue, shown);

  const float side = look.px(14), x = rect.low.x + look.px(30), y = std::round(rect.centre().y - side / 2);
  const Rect swatch{{x, y}, {x + side, y + side}};
  fill(swatch, rgb(tissue.colour.r, tissue.colour.g, tissue.colour.b), look.px(3));
  outline(swatch, look.theme.line2, look.px(3), look.line());

  const Rect name{{x + side, rect.low.y}, {rect.high.x - look.px(72), rect.high.y}};
  if (renaming) {
    std::string accepted = tissue.name;
    if (rename_field(
            context.ui,
            {{name.low.x + look.px(4), name.low.y + look.px(1)}, {name.high.x - look.px(4), name.high.y - look.px(1)}},
            accepted))
      rename_tissue(context, tissue.label, accepted);
    return;
  }
  const Pressed pressed = press_area(context.ui, "name", name);
  const Colour colour = shown.visible ? look.theme.text : chosen ? look.theme.text2 : look.theme.text3;
  const std::string label = std::to_string(tissue.label);
  const float label_left = name.high.x - std::ceil(text_size(look.fonts.mono, label).x) - 1;
  put_text(context.ui, look.fonts.regular, colour,
           Rect{{name.low.x + look.px(6), name.low.y}, {label_left - look.px(6), name.high.y}}, shown_name(tissue));
  put_text(context.ui, look.fonts.mono, chosen ? look.theme.text2 : look.theme.text3,
           Rect{{label_left, name.low.y}, name.high}, label, Align::Right);
  if (pressed.clicked) {
    focus_list(context.ui, kList, index);
    select_tissue(context, tissue.label, context.ui->input.down(Key::Ctrl) || context.ui->input.down(Key::Shift));
  }
  if (pressed.double_clicked) begin_renaming(context.ui, renamed_as(tissue), tissue.name);
  if (pressed.right_clicked) {
    if (!chosen) select_tissue(context, tissue.label, false);
    context.menus->open_popup = "Tissue";
  }
  draw_opacity(context, {{rect.high.x - look.px(66), rect.low.y}, {rect.high.x - look.px(10), rect.high.y}}, tissue,
               shown);
}

void take_key(Context& context, const std::vector<const Tissue*>& rows) {
  const ListKey key = list_key(context.ui, kList, static_cast<int>(rows.size()));
  if (key == ListKey::None || rows.empty()) return;
  const Tissue& tissue = *rows[context.ui->list_focus.row];
  if (key == ListKey::Moved || key == ListKey::Activate) select_tissue(context, tissue.label, false);
  if (key == ListKey::Rename) begin_renaming(context.ui, renamed_as(tissue), tissue.name);
  if (key == ListKey::Toggle) show_tissues(context, {tissue.label}, !look_of(context.document(), tissue.label).visible);
}

// Returns the tissues that match the search text: their name contains it, or their label is equal to it.
std::vector<const Tissue*> found(const Context& context, const TissueTable& tissues) {
  std::vector<const Tissue*> rows;
  for (const Tissue& tissue : tissues.tissues)
    if (contains_ignoring_case(shown_name(tissue), context.outliner->tissue_search) ||
        contains_ignoring_case(tissue.name, context.outliner->tissue_search) ||
        std::to_string(tissue.label) == context.outliner->tissue_search)
      rows.push_back(&tissue);
  return rows;
}

}  // namespace

void draw_tissues(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const auto tissues = context.document().tissues;  // copied, since drawing a row may change the document
  const std::string count = tissues ? std::to_string(tissues->tissues.size()) : "";
  if (column.begin_section("Tissues", count)) {
    if (!tissues) {
      const Rect rect = column.row(30);
      put_text(context.ui, look.fonts.regular, look.theme.text2,
               Rect{{rect.low.x + look.px(10), rect.low.y}, rect.high}, "Open a volume to see its tissues");
    } else {
      if (tissues->tissues.size() > 16) {
        const Rect rect = column.row(32);
        text_field(context.ui, "search",
                   {rect.low + glm::vec2(look.px(10), look.px(4)), rect.high - glm::vec2(look.px(10), look.px(4))},
                   context.outliner->tissue_search, "Search tissues");
      }
      const std::vector<const Tissue*> rows = found(context, *tissues);
      take_key(context, rows);
      for (int i = 0; i < std::ssize(rows); ++i) draw_row(context, column, i, *rows[i]);
      if (tissues->tissues.empty()) {
        const Rect rect = column.row(30);
        put_text(context.ui, look.fonts.regular, look.theme.text2,
                 Rect{{rect.low.x + look.px(10), rect.low.y}, rect.high},
                 context.views->image ? "No labels yet" : "No tissue: the volume is all air");
      } else if (rows.empty() &&
                 empty_state(context.ui, column.row(72), "No tissue named '" + context.outliner->tissue_search + "'",
                             "Clear search"))
        context.outliner->tissue_search.clear();
    }
  }
  column.end_section();
}

}  // namespace limber::editor
