// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that blend the pose towards the keys before and after the shown frame, copy the pose to the next key, and
// make the pose the rig's rest pose.
#pragma once

#include <optional>

#include "editor/context/operator.h"
#include "editor/pose/pose_tools.h"

namespace limber::editor {

struct Context;

std::vector<Operator> pose_neighbour_operators();

// Returns a blend of the selected bones from their last key before the shown frame (amount 0) to their first key after
// the shown frame (amount 1); nothing when one of these keys is missing.
std::optional<PoseBlend> between_keys(Context& context);

}  // namespace limber::editor
