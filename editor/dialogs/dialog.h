// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the frame of a dialog: its background, title and Close button. The dialog itself derives from Dialog
// (dialogs.h) and is opened by Dialogs::open().
#pragma once

#include <functional>
#include <string>

#include "editor/ui/widgets.h"

namespace limber::editor {

struct Context;

// Begins to draw a dialog in the middle of the window, and dims everything behind the dialog. Width and height are
// pixels at scale 1. Returns the rectangle of the dialog's content.
//   close  called by the dialog's Close button; empty: the button closes Dialogs::shown
Rect begin_dialog(Context& context, const std::string& title, float width, float height,
                  const std::function<void()>& close = {});
void end_dialog(Context& context);

}  // namespace limber::editor
