// SPDX-License-Identifier: AGPL-3.0-or-later
// Section of the Pose workspace's sidebar with the settings of the active strip. It is drawn only while the timeline
// shows strips.
#pragma once

#include "editor/ui/section.h"

namespace limber::editor {

struct Context;

void draw_strip_properties(Context& context, Column& column);

}  // namespace limber::editor
