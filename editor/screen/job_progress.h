// SPDX-License-Identifier: AGPL-3.0-or-later
// Returns the remaining time of a job as text.
#pragma once

#include <string>

namespace limber::editor {

std::string time_left_text(double seconds);  // returns the time as rounded text: "about 3 min"

}  // namespace limber::editor
