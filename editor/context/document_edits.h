// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Adds the document to the history as an edit named `label`, and requests a frame that shows it.
void commit(Editor& editor, const std::string& label, Document next);

// Returns the scale of the interface: the user's scale times the monitor's. The scale is smaller in a small window, as
// the window's regions need 800 x 520 pixels at scale 1.
float scale_for(const Preferences& preferences, const Host& host);
// Applies the theme and the scale if either has changed. Returns whether one has.
bool apply_look_if_changed(Editor& editor);

}  // namespace limber::editor
