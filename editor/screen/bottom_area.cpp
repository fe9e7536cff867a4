// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the area below the views: the console if it is open, else the timeline, else the table of results.
#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"

namespace limber::editor {

void draw_bottom(Context& context) {
  const Rect& rect = context.screen->layout.bottom;
  if (rect.empty()) return;
  begin_region(context.ui, Region::Bottom, "bottom", rect, context.ui->look.theme.panel);
  const Rect seen = context.screen->layout.uncovered(rect);
  if (context.screen->arrangement().console) draw_console(context, seen);
  else if (context.screen->arrangement().timeline) draw_timeline(context, seen);
  else draw_results(context, seen);
  end_region(context.ui);
}

}  // namespace limber::editor
