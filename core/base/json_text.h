// SPDX-License-Identifier: AGPL-3.0-or-later
// What every JSON text from a file passes before it is parsed. A value that is nested a million deep fits in two
// megabytes; the JSON library copies and prints by recursion, so such a value would end the program. And of two equal
// keys in one object it keeps one, which would be a silent choice.
#pragma once

#include <string>

namespace limber {

// Our deepest files (reports, glTF) have 12 levels.
constexpr int kDeepestJson = 64;

// What is wrong with the text: nested more than kDeepestJson levels, or a key twice in one object. Empty for sound
// JSON, and for what is no JSON at all, which the parser says better.
std::string json_problem(const std::string& text);

// The text itself.   throws Error with `where` when there is a problem
const std::string& checked_json(const std::string& text, const std::string& where);

// The text itself, or "" when there is a problem: for those to whom damaged text is no text.
const std::string& sound_json(const std::string& text);

}  // namespace limber
