// SPDX-License-Identifier: AGPL-3.0-or-later
// How long a job still takes, in words.
#pragma once

#include <string>

namespace limber::editor {

std::string time_left_text(double seconds);  // rounded: "about 3 min"

}  // namespace limber::editor
