// SPDX-License-Identifier: AGPL-3.0-or-later
// What each tissue of the volume amounts to, counted in a job.
#pragma once

#include <memory>

#include "editor/context/editor.h"

namespace limber::editor {

// Begins to count. Needs a volume and tissues.
std::unique_ptr<Dialog> open_statistics(Editor& editor);

}  // namespace limber::editor
