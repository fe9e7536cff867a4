// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of seams in the sidebar. Each row names two body parts that touch at a seam without being joined, and
// the number of the seam's voxel faces. A click on a row moves the crosshair to the seam.
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "seams";
constexpr int kMostRows = 8;

void go_to(Context& context, const SeamPair& pair) {
  context.views->cross_hair = pair.middle;
  context.ui->touch();
}

void draw_row(Context& context, Column& column, int index, const SeamPair& pair) {
  const Look& look = context.ui->look;
  Rect rect;
  const bool chosen = context.ui->list_focus.list == kList && context.ui->list_focus.row == index;
  if (!column.list_row(rect, index, chosen, kList)) return;
  const std::string name = capitalized(pair.first) + " to " + pair.second, faces = grouped(pair.faces);
  const PathScope path(context.ui, name);
  const Pressed pressed = press_area(context.ui, "name", rect);
  const float number = text_size(look.fonts.mono, faces).x, unit = look.px(38), end = rect.high.x - look.px(10);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {end - unit - number - look.px(8), rect.high.y}}, name);
  put_text(context.ui, look.fonts.mono, look.theme.text,
           Rect{{end - unit - number, rect.low.y}, {end - unit, rect.high.y}}, faces, Align::Right);
  put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{end - unit, rect.low.y}, {end, rect.high.y}}, "faces",
           Align::Right);
  if (pressed.hovered)
    tooltip(context.ui, rect, name,
            faces + " voxel faces touch but are not connected. Click to move the cross-hair to them.");
  if (!pressed.clicked) return;
  focus_list(context.ui, kList, index);
  go_to(context, pair);
}

void draw_rows(Context& context, Column& column, const std::vector<SeamPair>& pairs) {
  for (int i = 0; i < std::ssize(pairs); ++i) draw_row(context, column, i, pairs[static_cast<std::size_t>(i)]);
}

void draw_list(Context& context, Column& column) {
  const auto* counted = counted_pairs(context);
  const Look& look = context.ui->look;
  if (!counted)
    return put_text(context.ui, look.fonts.regular, look.theme.text3, column.row(24),
                    context.document().armature ? "Counting faces" : "Import a rig to list body parts", Align::Centre);
  const std::vector<SeamPair> pairs = *counted;  // a copy, so that the list stays valid if a row changes the count
  const ListKey key = list_key(context.ui, kList, static_cast<int>(pairs.size()));
  if (!pairs.empty() && (key == ListKey::Moved || key == ListKey::Activate))
    go_to(context, pairs[static_cast<std::size_t>(context.ui->list_focus.row)]);
  if (std::ssize(pairs) <= kMostRows) return draw_rows(context, column, pairs);
  Column list(context.ui, "list", column.row(24 * kMostRows));
  draw_rows(context, list, pairs);
}

void draw_foot(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Rect rect = column.row(38);
  float x = rect.low.x + look.px(10);
  const float y = rect.low.y + look.px(6);
  const Operator* find = find_operator(context.operators, "skin.find_seams");
  const float width = width_of_button(context.ui, {find->icon, find->label});
  operator_button(context, "skin.find_seams", {{x, y}, {x + width, y + look.px(26)}}, find->label);
  x += width + look.px(6);
  for (const char* id : {"skin.seam_brush", "skin.show_seams", "skin.clear_seams"}) {
    const Operator* op = find_operator(context.operators, id);
    operator_button(context, id, {{x, y}, {x + look.px(30), y + look.px(26)}}, "",
                    op->checked && op->checked(context) ? ButtonStyle::Soft : ButtonStyle::Plain);
    x += look.px(36);
  }
  if (context.document().seams)
    put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{x, y}, {rect.high.x - look.px(10), y + look.px(26)}},
             "Edited", Align::Right);
}

}  // namespace

void draw_seam_section(Context& context, Column& column) {
  if (!context.document().volume) return;
  const auto seams = shown_seams(context);
  const std::int64_t faces = seams && *seams ? (*seams)->size() : 0;
  if (column.begin_section("Seams", !seams ? "" : faces ? grouped(faces) + " faces" : "None", false)) {
    if (!seams) {
      const bool searching = context.seams->searching && context.background->tasks.contains(*context.seams->searching);
      if (empty_state(context.ui, column.row(72), searching ? "Finding seams" : "Seams not searched yet", "Find seams"))
        run(context, "skin.find_seams");
    } else {
      if (faces > 0) draw_list(context, column);
      else
        put_text(context.ui, context.ui->look.fonts.regular, context.ui->look.theme.text3, column.row(24),
                 context.document().seams ? "All seams were removed" : "No limbs touch", Align::Centre);
      draw_foot(context, column);
    }
  }
  column.end_section();
}

}  // namespace limber::editor
