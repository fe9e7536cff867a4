// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts the window's arrangements to JSON text and back. The text is stored in projects, and in the preferences for
// the next start of the program.
#pragma once

#include <string>

#include "editor/context/layout.h"

namespace limber::editor {

// Returns a JSON array with one object for each workspace.
std::string json_text(const Arrangements& arrangements);
// Sets the arrangements from JSON text. A setting that is missing in the text, or out of range, keeps its value. The
// exception is "maximized": if it is missing, no view is maximized.
void restore(const std::string& json, Arrangements& arrangements);

}  // namespace limber::editor
