// SPDX-License-Identifier: AGPL-3.0-or-later
// Section of the Pose workspace's sidebar that lists the active bone's constraints. Each constraint can be unfolded
// and has a weight with a key button, a target and settings.
#pragma once

#include "editor/ui/section.h"

namespace limber::editor {

struct Context;

void draw_constraints(Context& context, Column& column);

}  // namespace limber::editor
