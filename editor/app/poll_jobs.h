// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Commits the edits of finished jobs and reports failed jobs. Returns true if anything changed. Call once per frame.
bool poll_jobs(Editor& editor);

}  // namespace limber::editor
