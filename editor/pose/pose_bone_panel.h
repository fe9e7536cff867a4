// SPDX-License-Identifier: AGPL-3.0-or-later
// How the active bone stands in the Pose workspace, in numbers that can be dragged and typed: a hinge's angle, else the
// turn about the bone's own axes, x first, then y, then z; a root's place; what its joint allows.
#pragma once

#include "editor/ui/section.h"

namespace limber::editor {

void draw_posed_bone(Editor& editor, Column& column);

}  // namespace limber::editor
