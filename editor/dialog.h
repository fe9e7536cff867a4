// SPDX-License-Identifier: AGPL-3.0-or-later
// The frame of a dialog. A panel derives from Dialog (editor.h) and is put into Editor::dialog.
#pragma once

#include <string>

#include "editor/widgets.h"

namespace limber::editor {

// Centred on the window, everything behind it dimmed; height 0: as high as its content. Width and height at scale 1.
// Returns the content's rectangle. Escape closes it unless `stays`.
Rect begin_dialog(Editor& editor, const std::string& title, float width, float height);
void end_dialog(Editor& editor);

}  // namespace limber::editor
