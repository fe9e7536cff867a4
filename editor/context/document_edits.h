// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// An edit of the user's own: commits the document and shows it.
void commit(Editor& editor, const std::string& label, Document next);

// The user's scale times the monitor's, or less where the window is too small for it: the regions need 800 x 520.
float scale_for(const Preferences& preferences, const Host& host);
// Follows a change of the theme or scale. True when the look changed.
bool apply_look_if_changed(Editor& editor);

}  // namespace limber::editor
