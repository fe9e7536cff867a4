// SPDX-License-Identifier: AGPL-3.0-or-later
// What the project holds: the volume, its tissues, the bones, the results.
#include "editor/icons.h"
#include "editor/panels/panels.h"
#include "editor/tissues.h"

namespace limber::editor {

namespace {

struct Row {
  std::string name, count;
  const char* icon;
  int depth = 0;
  bool folds = false, open = false, chosen = false;
};

// Returns whether its name was pressed; the triangle folds by itself.
Pressed draw_row(Editor& editor, Column& column, int index, const Row& row, bool* open) {
  const Look& look = editor.look;
  Rect rect;
  if (!column.list_row(rect, index, row.chosen)) return {};
  const PathScope path(editor, row.name + "#" + std::to_string(index));
  const float x = rect.low.x + look.px(8 + 16 * row.depth);
  if (row.folds) {
    const Rect fold{{x, rect.low.y}, {x + look.px(18), rect.high.y}};
    if (press_area(editor, "fold", fold).clicked && open) *open = !*open;
    put_icon(look.fonts.regular, look.theme.text2, fold, row.open ? icon::kOpened : icon::kClosed);
  }
  const Rect name{{x + look.px(20), rect.low.y}, {rect.high.x - look.px(104), rect.high.y}};
  const Pressed pressed = press_area(editor, "name", name);
  put_icon(look.fonts.regular, row.chosen ? look.theme.accent_text : look.theme.text2, Rect{name.low, {name.low.x + look.px(18), name.high.y}}, row.icon);
  put_text(editor, look.fonts.regular, look.theme.text, Rect{{name.low.x + look.px(24), name.low.y}, name.high}, row.name);
  put_text(editor, look.fonts.small, row.chosen ? look.theme.text2 : look.theme.text3, Rect{{name.high.x, rect.low.y}, {rect.high.x - look.px(10), rect.high.y}}, row.count,
           Align::Right);
  return pressed;
}

std::string size_text(const Grid& grid) {
  return std::to_string(grid.size.x) + "\u00d7" + std::to_string(grid.size.y) + "\u00d7" + std::to_string(grid.size.z);
}

}  // namespace

void draw_outliner(Editor& editor, Column& column) {
  if (column.begin_section("Outliner")) {
    const Document& document = editor.document();
    int index = 0;
    if (!document.volume) {
      Rect rect = column.row(30);
      put_text(editor, editor.look.fonts.regular, editor.look.theme.text2, Rect{{rect.low.x + editor.look.px(14), rect.low.y}, rect.high}, "Nothing is open");
    } else {
      draw_row(editor, column, index++, {editor.name.empty() ? "Volume" : editor.name, size_text(document.volume->grid), icon::kVolume}, nullptr);
      const std::string tissues = std::to_string(document.tissues ? document.tissues->tissues.size() : 0);
      if (draw_row(editor, column, index++, {"Tissues", tissues, icon::kTissues, 1}, nullptr).clicked) editor.open_sections["Tissues"] = true;
    }
    if (document.armature) {
      draw_row(editor, column, index++, {"Armature", std::to_string(document.armature->bones.size()), icon::kRig}, nullptr);
      std::vector<int> depth(document.armature->bones.size());
      for (int b = 0; b < std::ssize(document.armature->bones); ++b) {
        const Bone& bone = document.armature->bones[b];
        depth[b] = bone.parent < 0 ? 1 : std::min(depth[bone.parent] + 1, 8);
        if (draw_row(editor, column, index++, {bone.name, "", icon::kDot, depth[b], false, false, editor.selection.bone == b}, nullptr).clicked) {
          editor.selection.bone = b;
          editor.selection.bones = {b};
        }
      }
    }
    for (const auto& result : document.results) draw_row(editor, column, index++, {result->name, result->method, icon::kResample}, nullptr);
  }
  column.end_section();
}

}  // namespace limber::editor
