// SPDX-License-Identifier: AGPL-3.0-or-later
// Handles texts that may contain bytes that are not UTF-8, for example Latin-1 text in files by unknown authors.
#pragma once

#include <string>
#include <string_view>

namespace limber {

// Returns the number of bytes of the UTF-8 character at the start of `text`; 0 if `text` does not start with a valid
// one.
std::size_t utf8_size(std::string_view text);
// Returns the text with each byte that is not UTF-8 replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

}  // namespace limber
