// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/project/document.h"

namespace limber::editor {

class Host;
struct Context;
struct Preferences;

// Adds the document to the undo history as an edit named `label`, and requests a frame that shows the document.
void commit(Context& context, const std::string& label, Document next);

// Returns the scale of the interface: the user's scale times the monitor's. In a small window the scale is smaller,
// since the window's regions need 800 x 520 pixels at scale 1.
float scale_for(const Preferences& preferences, const Host& host);
// Applies the theme and the scale if one of them has changed. Returns true if it has applied them.
bool apply_look_if_changed(Context& context);

}  // namespace limber::editor
