// SPDX-License-Identifier: AGPL-3.0-or-later
// The user guide as pages for a browser: one HTML file a page, with the chapters at the side and a search in plain
// JavaScript. They need no network, and are light or dark as the reader's system is.
#pragma once

#include <map>
#include <string>

#include "core/base/file.h"
#include "editor/guide/book.h"

namespace limber::editor {

// Returns the files of the book without its pictures: their names, such as "index.html", and their contents.
std::map<std::string, std::string> html_files(const Book& book);

// Writes the book into the folder, with copies of its pictures. The folder is made where it is absent. Throws Error
// when a file cannot be written.
void write_guide_html(const Book& book, const Path& folder);

}  // namespace limber::editor
