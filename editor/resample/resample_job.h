// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose of the moment as a new label volume. It runs in a process of its own (core/project/worker.h), so that a
// crash, a lack of memory, a hang or a time limit is a message, and the document stays as it was; its end is one edit,
// a result.
#pragma once

#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// Needs volume, tissues, armature and weights.
void start_resampling(Editor& editor);
// "" when there is all that it needs.
std::string why_no_resampling(const Editor& editor);

// Ids of the operators that choose a deformation method, in the order of its table.
std::vector<std::string> method_operators(Methods which);

}  // namespace limber::editor
