// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the row of a table of tissue properties that fits a tissue: by the words of the tissue's name, else by its
// kind.
#pragma once

#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/tissue/tissue_table.h"

namespace limber {

// The words of a name in lower case: "vertebrae_C1", "BoneMarrow" and "tendon/ligament" have two words each.
using TissueWords = std::set<std::string, std::less<>>;
TissueWords words_in_tissue_name(std::string_view name);
// Returns whether the words contain `word` or its plural with s.
bool has_word(const TissueWords& words, std::string_view word);

struct TissueNames {
  std::string name;
  std::vector<std::string>
      synonyms;                   // alternative names; a tissue matches when its name contains all words of one of them
  std::vector<TissueKind> kinds;  // a tissue of one of these kinds gets this row when no name matches
  std::vector<TissueWords> words;  // words of `name`, then of each synonym
  std::vector<bool> whole =
      {};                // #words: true for a synonym written "=head", which must equal all words of the tissue's name
  bool is_bone = false;  // the row is a bone; a muscle never matches it, though many are named after bones
};

struct TissueMatch {
  int row = -1;          // -1: none
  bool by_name = false;  // false: matched by the tissue's kind
  std::string words;     // the name or synonym that matched the tissue's name
};

// Returns the row with the longest name or synonym, in words, whose words all occur in the tissue's name. On a tie, a
// row of the tissue's kind wins, then the first row. When no name matches, returns the first row of the tissue's kind.
TissueMatch match_tissue(const Tissue& tissue, std::span<const TissueNames> rows);
// Finds the row as the overload above does, in a table of `rows` rows; names(i) returns the names of row i.
TissueMatch match_tissue(const Tissue& tissue, std::size_t rows,
                         const std::function<const TissueNames&(std::size_t)>& names);

// Returns the fields of a line of comma-separated values. A field in double quotes may contain commas, and "" inside
// such a field means one quote.
std::vector<std::string> csv_fields(std::string_view line);
std::string csv_field(const std::string& text);  // returns `text` as a field, in quotes when needed

// Parses the first three fields of a row: `name`, `names` (synonyms) and `kinds`. Throws Error for an unknown kind.
TissueNames tissue_names_of(const std::vector<std::string>& fields, const std::string& where);

}  // namespace limber
