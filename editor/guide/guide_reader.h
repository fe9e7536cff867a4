// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog that shows the user guide as a book: chapters and pages at the left, the page with its pictures at the
// right, and a field that searches all pages.
#pragma once

#include <memory>

#include "editor/guide/book.h"

namespace limber::editor {

class Dialog;
struct Context;

// Reads the guide, with the keys that the editor has now. Throws Error when a page of the guide is missing.
Book read_guide(const Context& context);
// Makes the dialog.
//   page, block  what the dialog shows first: an index into the book's pages, and the block of this page that is
//                marked; 0: no block
std::unique_ptr<Dialog> open_guide(Book book, int page = 0, int block = 0);

}  // namespace limber::editor
