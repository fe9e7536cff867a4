// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog that shows the user guide as a book: chapters and pages at the left, the page with its pictures at the
// right, and a field that searches all pages.
#pragma once

#include <memory>

#include "editor/context/editor.h"

namespace limber::editor {

// Reads the guide and makes the dialog. Throws Error when a page of the guide is missing.
std::unique_ptr<Dialog> open_guide(const Editor& editor);

}  // namespace limber::editor
