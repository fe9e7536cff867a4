// SPDX-License-Identifier: AGPL-3.0-or-later
// The frame of a dialog. A panel derives from Dialog (editor.h) and is put into Editor::dialog.
#pragma once

#include <functional>
#include <string>

#include "editor/ui/widgets.h"

namespace limber::editor {

// Centred on the window, everything behind it dimmed; height 0: as high as its content. Width and height at scale 1.
// Returns the content's rectangle. `close`: what its cross does, in place of closing Editor::dialog.
Rect begin_dialog(Editor& editor, const std::string& title, float width, float height,
                  const std::function<void()>& close = {});
void end_dialog(Editor& editor);

}  // namespace limber::editor
