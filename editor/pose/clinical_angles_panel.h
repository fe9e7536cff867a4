// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel "Clinical angles" of the Pose workspace: the joints of the active bone in clinical terms. Each angle has a
// number, which the user drags or types, and a slider, whose bar shows the range of the motion. A list selects any
// joint that is known by the names of its bones; hands also curl and spread their fingers.
#pragma once

#include "editor/ui/section.h"

namespace limber::editor {

struct Context;

void draw_clinical_angles(Context& context, Column& column);

}  // namespace limber::editor
