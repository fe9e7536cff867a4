// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads the state of the editor that a project's file stores beside the document: workspace, window
// arrangement, cameras, display settings. The format is JSON. For a value that cannot be read, the editor keeps its
// own.
#pragma once

#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

std::string editor_state(const Editor& editor);
void restore_editor_state(Editor& editor, const std::string& json);

}  // namespace limber::editor
