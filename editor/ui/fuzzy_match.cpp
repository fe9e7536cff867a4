// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/fuzzy_match.h"

#include <algorithm>
#include <cctype>

namespace limber::editor {

namespace {

// Scores of a matched letter at the text's beginning, at a word's beginning and after another matched letter, and the
// cost of a skipped word. Only the order of these numbers matters.
constexpr int kTextStart = 24, kWordStart = 12, kInARow = 10, kSkippedWord = 2;
constexpr int kNone = -1'000'000;

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) || (c & 0x80); }
bool begins_word(std::string_view text, std::size_t i) {
  return is_letter(text[i]) && (i == 0 || !is_letter(text[i - 1]));
}

// Finds the positions in the text at which the word's letters match with the highest score, by dynamic programming over
// (letter, position). Returns no value if the letters do not match.
std::optional<FuzzyMatch> match_word(std::string_view word, std::string_view text) {
  const std::size_t m = word.size(), n = text.size();
  if (m > n) return std::nullopt;
  std::vector<int> score(m * n, kNone);
  std::vector<std::size_t> from(m * n, 0);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = i; j < n; ++j) {
      if (lower(word[i]) != lower(text[j])) continue;
      int& best = score[i * n + j];
      const bool start = begins_word(text, j);
      if (i == 0) {
        if (start) best = j == 0 ? kTextStart : kWordStart;
        continue;
      }
      const auto come_from = [&](std::size_t k, int gain) {
        const int before = score[(i - 1) * n + k];
        if (before == kNone || before + gain <= best) return;
        best = before + gain;
        from[i * n + j] = k;
      };
      come_from(j - 1, kInARow);
      if (!start) continue;
      int skipped = 0;
      for (std::size_t k = j - 1; k-- > 0;) {
        skipped += begins_word(text, k + 1);
        come_from(k, kWordStart - 4 - kSkippedWord * skipped);
      }
    }
  const auto last = score.begin() + static_cast<std::ptrdiff_t>((m - 1) * n);
  const auto best = std::max_element(last, last + static_cast<std::ptrdiff_t>(n));
  if (*best == kNone) return std::nullopt;
  FuzzyMatch match{*best, std::vector<std::size_t>(m)};
  std::size_t j = static_cast<std::size_t>(best - last);
  for (std::size_t i = m; i-- > 0; j = from[i * n + j]) match.letters[i] = j;
  return match;
}

}  // namespace

std::optional<FuzzyMatch> fuzzy_match(std::string_view query, std::string_view text) {
  FuzzyMatch all;
  for (std::size_t at = 0; at < query.size();) {
    const std::size_t end = std::min(query.find(' ', at), query.size());
    if (end > at) {
      const auto match = match_word(query.substr(at, end - at), text);
      if (!match) return std::nullopt;
      all.score += match->score;
      all.letters.insert(all.letters.end(), match->letters.begin(), match->letters.end());
    }
    at = end + 1;
  }
  std::sort(all.letters.begin(), all.letters.end());
  all.letters.erase(std::unique(all.letters.begin(), all.letters.end()), all.letters.end());
  return all;
}

bool contains_ignoring_case(std::string_view text, std::string_view part) {
  const auto equal = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::search(text.begin(), text.end(), part.begin(), part.end(), equal) != text.end();
}

}  // namespace limber::editor
