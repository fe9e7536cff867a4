// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads the editor's state that a project file stores in addition to the document: workspace, window
// arrangement, cameras, display settings. The format is JSON. If a value cannot be read, the editor keeps its current
// value.
#pragma once

#include <string>

namespace limber::editor {

struct Context;

std::string editor_state(const Context& context);
void restore_editor_state(Context& context, const std::string& json);

}  // namespace limber::editor
