// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace limber::editor {

struct Context;

// Applies the edits of finished jobs to the document and reports failed jobs. Returns true if anything changed. Call it
// once per frame.
bool poll_jobs(Context& context);

}  // namespace limber::editor
