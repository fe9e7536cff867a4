// SPDX-License-Identifier: AGPL-3.0-or-later
// The area below the views: the console where it is open, else the results.
#include "editor/panels/panels.h"

namespace limber::editor {

void draw_bottom(Editor& editor) {
  const Rect& rect = editor.layout.bottom;
  if (rect.empty()) return;
  begin_region(editor, Region::Bottom, "bottom", rect, editor.look.theme.panel);
  editor.arrangement().console ? draw_console(editor, rect) : draw_results(editor, rect);
  end_region(editor);
}

}  // namespace limber::editor
