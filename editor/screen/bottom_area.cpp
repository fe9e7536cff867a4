// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the area below the views: the console if it is open, else the timeline, else the table of results.
#include "editor/context/panels.h"

namespace limber::editor {

void draw_bottom(Editor& editor) {
  const Rect& rect = editor.layout.bottom;
  if (rect.empty()) return;
  begin_region(editor, Region::Bottom, "bottom", rect, editor.look.theme.panel);
  Rect seen = rect;
  if (editor.layout.sidebar_over_views && !editor.layout.sidebar.empty())
    seen.high.x = std::min(seen.high.x, editor.layout.sidebar.low.x);
  if (editor.arrangement().console) draw_console(editor, seen);
  else if (editor.arrangement().timeline) draw_timeline(editor, seen);
  else draw_results(editor, seen);
  end_region(editor);
}

}  // namespace limber::editor
