// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel of the active bone in the Pose workspace. The user can drag or type its numbers: the angle of a hinge, or for
// other joints the turns about the bone's local axes (x first, then y, then z); the quaternion; and the offset of a
// root bone. The panel also shows the joint's limits.
#pragma once

#include "editor/ui/section.h"

namespace limber::editor {

struct Context;

void draw_posed_bone(Context& context, Column& column);

}  // namespace limber::editor
