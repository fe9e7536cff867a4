// SPDX-License-Identifier: AGPL-3.0-or-later
// Computing how tissue follows the bones, as a job and one edit.
#pragma once

#include "editor/editor.h"

namespace limber::editor {

enum class BindingMethod { Heat, Geodesic, Rigid };
// Needs a volume, tissues and an armature.
void start_binding(Editor& editor, BindingMethod method);

}  // namespace limber::editor
