// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog with a table of the tissues: each tissue's number of voxels, its volume and its number of separate parts. A
// background job counts them.
#pragma once

#include <memory>

namespace limber::editor {

class Dialog;
struct Context;

// Starts the job that counts, and returns the dialog that shows its result. The document must have a volume and
// tissues.
std::unique_ptr<Dialog> open_statistics(Context& context);

}  // namespace limber::editor
