// SPDX-License-Identifier: AGPL-3.0-or-later
// How the window is arranged, as JSON text: kept in a project and, for the next start, in the preferences.
#pragma once

#include <string>

#include "editor/context/layout.h"

namespace limber::editor {

// An array, one for each workspace.
std::string json_text(const Arrangements& arrangements);
// What is missing or out of range stays as it is; where no view is named as maximized, none is.
void restore(const std::string& json, Arrangements& arrangements);

}  // namespace limber::editor
