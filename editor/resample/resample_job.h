// SPDX-License-Identifier: AGPL-3.0-or-later
// Resamples the current pose into a new label volume. The work runs in a separate process (core/project/worker.h), so
// that a crash, a lack of memory, a hang or a time limit only gives a message and leaves the document unchanged. When
// the process ends, the job commits one edit that adds a result to the document.
#pragma once

#include <string>

#include "core/resample/deformation_method.h"

namespace limber::editor {

struct Context;

// Starts the job that resamples the current pose. The document must have a volume, tissues, an armature and weights.
void start_resampling(Context& context);
// Returns what is missing for resampling, such as "Import a rig first"; "" when nothing is missing.
std::string why_no_resampling(const Context& context);

// Returns the ids of the operators that select a deformation method, in the order of deformation_methods().
std::vector<std::string> method_operators(Methods which);

}  // namespace limber::editor
