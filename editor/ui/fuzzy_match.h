// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds names by a few of their letters, ignoring case. Every word of the query must match on its own. Its first letter
// must begin a word of the name; each further letter must directly follow the letter matched before it, or begin a
// later word. So "fa" and "fr all" find "Frame all". "rame" does not, since words matched in their middle would find
// too many names.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace limber::editor {

struct FuzzyMatch {
  // How well the query matches; higher is better. If scores are equal, prefer the shorter text.
  int score = 0;
  std::vector<std::size_t> letters;  // byte positions of the matched letters in the text, ascending
};

// Returns the best match of the query in the text, or no value if the query does not match. A match at the text's
// beginning scores higher than a match at a later word, and adjacent letters score higher than scattered ones. An empty
// query matches every text with score 0.
std::optional<FuzzyMatch> fuzzy_match(std::string_view query, std::string_view text);

// Returns true if `text` contains `part` as one uninterrupted substring, ignoring case.
bool contains_ignoring_case(std::string_view text, std::string_view part);

}  // namespace limber::editor
