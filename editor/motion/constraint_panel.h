// SPDX-License-Identifier: AGPL-3.0-or-later
// Section of the Pose workspace that lists the active bone's constraints: each folds, has its weight with a key, and
// its target and settings.
#pragma once

#include "editor/context/editor.h"
#include "editor/ui/section.h"

namespace limber::editor {

void draw_constraints(Editor& editor, Column& column);

}  // namespace limber::editor
