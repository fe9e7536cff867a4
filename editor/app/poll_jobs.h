// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "editor/context/editor.h"

namespace limber::editor {

// Commits what jobs have done and tells of those that failed, once a frame. True when anything changed.
bool poll_jobs(Editor& editor);

}  // namespace limber::editor
