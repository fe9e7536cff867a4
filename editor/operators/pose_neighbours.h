// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses in time and at rest: towards the keys before and after, on to the next key, into the rig itself.
#pragma once

#include "editor/operators/operator.h"

namespace limber::editor {

std::vector<Operator> pose_neighbour_operators();

}  // namespace limber::editor
