// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog that shows the user guide as a book: chapters and pages at the left, the page with its pictures at the
// right, and a field that searches all pages.
#pragma once

#include <memory>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// Makes the dialog. Throws Error when a page of the guide is missing.
//   search  what the search field holds at first
std::unique_ptr<Dialog> open_guide(const std::string& search = "");

}  // namespace limber::editor
