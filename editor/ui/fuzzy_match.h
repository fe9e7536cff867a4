// SPDX-License-Identifier: AGPL-3.0-or-later
// Finding names by a few of their letters. Every word of the query must be found, each by itself, ignoring case: its
// first letter begins a word of the text, and every further one follows the one before or begins a later word. So "fa"
// and "fr all" find "Frame all", "rame" does not, nor do letters picked from the middles of words.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace limber::editor {

struct FuzzyMatch {
  int score = 0;                     // higher is better; of equal ones the shorter text should win
  std::vector<std::size_t> letters;  // bytes of the text that were matched, ascending
};

// Better: at the text's beginning before a later word's, letters in a row before scattered ones.
// An empty query matches everything with score 0.
std::optional<FuzzyMatch> fuzzy_match(std::string_view query, std::string_view text);

// For the search in lists of anything: the part as it stands, ignoring case.
bool contains_ignoring_case(std::string_view text, std::string_view part);

}  // namespace limber::editor
