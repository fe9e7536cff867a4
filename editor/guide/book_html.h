// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the user guide as web pages: one HTML file for each page of the guide, with the chapters at the side and a
// search in plain JavaScript. The pages need no network, and follow the system's light or dark theme.
#pragma once

#include <map>
#include <string>

#include "core/base/file.h"
#include "editor/guide/book.h"

namespace limber::editor {

// Returns the HTML files of the book, without pictures: the contents by file name, such as "index.html".
std::map<std::string, std::string> html_files(const Book& book);

// Writes the book and copies of its pictures into the folder, which is created if it does not exist. Throws Error if a
// file cannot be written.
void write_guide_html(const Book& book, const Path& folder);

}  // namespace limber::editor
