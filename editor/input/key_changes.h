// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace limber::editor {

// The user's changes, by context and operator id: the chords that replace the operator's original chords.
using KeyChanges = std::map<std::pair<std::string, std::string>, std::vector<std::string>>;

}  // namespace limber::editor
