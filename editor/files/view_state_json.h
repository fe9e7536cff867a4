// SPDX-License-Identifier: AGPL-3.0-or-later
// What of the editor belongs to a project and is not its document: workspace, arrangement of the window, cameras, what
// is shown. Kept as JSON in the project's file; whatever of it cannot be read is left as it is.
#pragma once

#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

std::string editor_state(const Editor& editor);
void restore_editor_state(Editor& editor, const std::string& json);

}  // namespace limber::editor
