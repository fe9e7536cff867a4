// SPDX-License-Identifier: AGPL-3.0-or-later
// The program's own documents, read in the window: chapters at the left, the text beside them.
#pragma once

#include <memory>
#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// `asset_name`: a Markdown file of the assets. Throws Error when it is missing.
std::unique_ptr<Dialog> open_document(const std::string& title, const std::string& asset_name);

// A document with the rows of the program's tables, as words, in place of "{table.volume_formats}" and the like.
std::string with_tables(std::string text);

}  // namespace limber::editor
