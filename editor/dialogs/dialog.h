// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the frame of a dialog: its background, title and Close button. The dialog itself derives from Dialog (editor.h)
// and is opened by Editor::open_dialog().
#pragma once

#include <functional>
#include <string>

#include "editor/ui/widgets.h"

namespace limber::editor {

struct Editor;

// Begins to draw a dialog in the middle of the window, and dims everything behind the dialog. Width and height are
// pixels at scale 1. Returns the rectangle of the dialog's content.
//   close  called by the dialog's Close button; empty: the button closes Editor::dialog
Rect begin_dialog(Editor& editor, const std::string& title, float width, float height,
                  const std::function<void()>& close = {});
void end_dialog(Editor& editor);

}  // namespace limber::editor
