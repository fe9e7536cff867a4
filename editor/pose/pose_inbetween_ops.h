// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that blend the pose towards the keys before and after the shown frame, copy the pose to the next key, and
// make the pose the rig's rest pose.
#pragma once

#include <optional>

#include "editor/context/operator.h"
#include "editor/pose/pose_tools.h"

namespace limber::editor {

std::vector<Operator> pose_neighbour_operators();

// Returns a blend whose amount goes from the selected bones' last key before the shown frame to their first key after
// it; nothing when either key is missing.
std::optional<Blend> between_keys(Editor& editor);

}  // namespace limber::editor
