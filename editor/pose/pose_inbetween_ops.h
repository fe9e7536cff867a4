// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses in time and at rest: towards the keys before and after, on to the next key, into the rig itself.
#pragma once

#include <optional>

#include "editor/context/operator.h"
#include "editor/pose/pose_tools.h"

namespace limber::editor {

std::vector<Operator> pose_neighbour_operators();

// From the key of the chosen bones before the frame to the one after it; nothing where they have not both.
std::optional<Blend> between_keys(Editor& editor);

}  // namespace limber::editor
