// SPDX-License-Identifier: AGPL-3.0-or-later
// How the window is arranged, as it is kept in a project and, for the next start, in the preferences.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "editor/layout.h"

namespace limber::editor {

nlohmann::json json_of(const Arrangement& arrangement);
// What is missing or out of range stays as it is; where no view is named as maximized, none is.
void restore(const nlohmann::json& json, Arrangement& arrangement);

// One for each workspace.
nlohmann::json json_of(const Arrangements& arrangements);
void restore(const nlohmann::json& json, Arrangements& arrangements);

}  // namespace limber::editor
