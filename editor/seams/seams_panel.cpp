// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of seams in the sidebar. Each row names two body parts that touch at a seam without being joined, and
// the number of the seam's voxel faces. A click on a row moves the crosshair to the seam.
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "seams";
constexpr int kMostRows = 8;

void go_to(Editor& editor, const SeamPair& pair) {
  editor.views->cross_hair = pair.middle;
  editor.touch();
}

void draw_row(Editor& editor, Column& column, int index, const SeamPair& pair) {
  const Look& look = editor.look;
  Rect rect;
  const bool chosen = editor.list_focus.list == kList && editor.list_focus.row == index;
  if (!column.list_row(rect, index, chosen, kList)) return;
  const std::string name = capitalized(pair.first) + " to " + pair.second, faces = grouped(pair.faces);
  const PathScope path(editor, name);
  const Pressed pressed = press_area(editor, "name", rect);
  const float number = text_size(look.fonts.mono, faces).x, unit = look.px(38), end = rect.high.x - look.px(10);
  put_text(editor, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {end - unit - number - look.px(8), rect.high.y}}, name);
  put_text(editor, look.fonts.mono, look.theme.text, Rect{{end - unit - number, rect.low.y}, {end - unit, rect.high.y}},
           faces, Align::Right);
  put_text(editor, look.fonts.small, look.theme.text2, Rect{{end - unit, rect.low.y}, {end, rect.high.y}}, "faces",
           Align::Right);
  if (pressed.hovered)
    tooltip(editor, rect, name,
            faces + " voxel faces touch but are not connected. Click to move the cross-hair to them.");
  if (!pressed.clicked) return;
  focus_list(editor, kList, index);
  go_to(editor, pair);
}

void draw_rows(Editor& editor, Column& column, const std::vector<SeamPair>& pairs) {
  for (int i = 0; i < std::ssize(pairs); ++i) draw_row(editor, column, i, pairs[static_cast<std::size_t>(i)]);
}

void draw_list(Editor& editor, Column& column) {
  const auto* counted = counted_pairs(editor);
  const Look& look = editor.look;
  if (!counted)
    return put_text(editor, look.fonts.regular, look.theme.text3, column.row(24),
                    editor.document().armature ? "Counting faces" : "Import a rig to list body parts", Align::Centre);
  const std::vector<SeamPair> pairs = *counted;  // a copy, so that the list stays valid if a row changes the count
  const ListKey key = list_key(editor, kList, static_cast<int>(pairs.size()));
  if (!pairs.empty() && (key == ListKey::Moved || key == ListKey::Activate))
    go_to(editor, pairs[static_cast<std::size_t>(editor.list_focus.row)]);
  if (std::ssize(pairs) <= kMostRows) return draw_rows(editor, column, pairs);
  Column list(editor, "list", column.row(24 * kMostRows));
  draw_rows(editor, list, pairs);
}

void draw_foot(Editor& editor, Column& column) {
  const Look& look = editor.look;
  const Rect rect = column.row(38);
  float x = rect.low.x + look.px(10);
  const float y = rect.low.y + look.px(6);
  const Operator* find = find_operator(editor, "skin.find_seams");
  const float width = width_of_button(editor, {find->icon, find->label});
  operator_button(editor, "skin.find_seams", {{x, y}, {x + width, y + look.px(26)}}, find->label);
  x += width + look.px(6);
  for (const char* id : {"skin.seam_brush", "skin.show_seams", "skin.clear_seams"}) {
    const Operator* op = find_operator(editor, id);
    operator_button(editor, id, {{x, y}, {x + look.px(30), y + look.px(26)}}, "",
                    op->checked && op->checked(editor) ? ButtonStyle::Soft : ButtonStyle::Plain);
    x += look.px(36);
  }
  if (editor.document().seams)
    put_text(editor, look.fonts.small, look.theme.text2, Rect{{x, y}, {rect.high.x - look.px(10), y + look.px(26)}},
             "Edited", Align::Right);
}

}  // namespace

void draw_seam_section(Editor& editor, Column& column) {
  if (!editor.document().volume) return;
  const auto seams = shown_seams(editor);
  const std::int64_t faces = seams && *seams ? (*seams)->size() : 0;
  if (column.begin_section("Seams", !seams ? "" : faces ? grouped(faces) + " faces" : "None", false)) {
    if (!seams) {
      const bool searching = editor.seams->searching && editor.tasks.contains(*editor.seams->searching);
      if (empty_state(editor, column.row(72), searching ? "Finding seams" : "Seams not searched yet", "Find seams"))
        run(editor, "skin.find_seams");
    } else {
      if (faces > 0) draw_list(editor, column);
      else
        put_text(editor, editor.look.fonts.regular, editor.look.theme.text3, column.row(24),
                 editor.document().seams ? "All seams were removed" : "No limbs touch", Align::Centre);
      draw_foot(editor, column);
    }
  }
  column.end_section();
}

}  // namespace limber::editor
