// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks every JSON text from a file before it is parsed. A value nested a million levels deep fits in two megabytes,
// and the JSON library, which copies and prints by recursion, would overflow the stack on it. If a key occurs twice in
// an object, the library keeps one of them without a message.
#pragma once

#include <string>

namespace limber {

// A JSON text with more levels of nesting is refused. The deepest files that Limber writes or reads (reports, glTF)
// have 12 levels.
constexpr int kDeepestJson = 64;

// Returns what is wrong with the text, as a message: nesting deeper than kDeepestJson levels, or a key twice in one
// object. Returns "" for JSON without these problems. Also returns "" for text that is not JSON, because the parser's
// own message is better.
std::string json_problem(const std::string& text);

// Returns `text` itself. Throws Error with `where` (the file) when json_problem() finds a problem in the text.
const std::string& checked_json(const std::string& text, const std::string& where);

// Returns `text` itself, or "" when json_problem() finds a problem in it, for callers that treat damaged text as
// missing.
const std::string& sound_json(const std::string& text);

}  // namespace limber
