// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog that shows a document that comes with the program, such as what is new. A list of chapters is at the left,
// the text is at the right.
#pragma once

#include <memory>
#include <string>

namespace limber::editor {

class Dialog;

// Makes a dialog that shows a Markdown file of the assets. Throws Error when the file is missing.
std::unique_ptr<Dialog> open_document(const std::string& title, const std::string& asset_name);

// Replaces marks such as "{table.volume_formats}" in a document by the contents of the program's tables, so that the
// documents always list what the program supports. Returns the new text.
std::string with_tables(std::string text);

}  // namespace limber::editor
