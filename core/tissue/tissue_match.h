// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the row that belongs to a tissue in a table of tissue properties: by the words of the tissue's name, or if none
// match, by its kind.
#pragma once

#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/tissue/tissue_table.h"

namespace limber {

// The set of words in a name, in lower case and without digits: "vertebrae_C1", "BoneMarrow" and "tendon/ligament" have
// two words each.
using TissueWords = std::set<std::string, std::less<>>;
TissueWords words_in_tissue_name(std::string_view name);
// Returns true if `words` contains `word` or its plural with s.
bool has_word(const TissueWords& words, std::string_view word);

struct TissueNames {
  std::string name;
  std::vector<std::string> synonyms;  // alternative names; one matches if the tissue's name contains all of its words
  std::vector<TissueKind> kinds;      // a tissue of one of these kinds gets this row when no name matches
  std::vector<TissueWords> words;     // sets of words: those of `name`, then those of each synonym
  // #words: true for a synonym written "=head", which must equal all words of the tissue's name.
  std::vector<bool> whole = {};
  bool is_bone = false;  // true: the row is a bone; muscles never match it, though many muscles are named after bones
};

struct TissueMatch {
  int row = -1;          // index of the matching row; -1: none
  bool by_name = false;  // false: the row matched by the tissue's kind
  std::string words;     // the name or synonym that matched the tissue's name
};

// Returns the row whose name or synonym has the most words, all of which occur in the tissue's name. Among equal rows,
// one of the tissue's kind wins, then the first row. If no name matches, returns the first row of the tissue's kind.
TissueMatch match_tissue(const Tissue& tissue, std::span<const TissueNames> rows);
// Returns the row that the other match_tissue() finds, for a table of `rows` rows. names(i) returns the names of row i.
TissueMatch match_tissue(const Tissue& tissue, std::size_t rows,
                         const std::function<const TissueNames&(std::size_t)>& names);

// Returns the fields of a line of comma-separated values. A field in double quotes may contain commas, and "" inside it
// means one quote.
std::vector<std::string> csv_fields(std::string_view line);
std::string csv_field(const std::string& text);  // returns `text` as a field of a line, in quotes if needed

// Parses the first three fields of a table's row: `name`, `names` (synonyms) and `kinds`. Throws Error for an unknown
// kind.
//   where  the file and line, for messages
TissueNames tissue_names_of(const std::vector<std::string>& fields, const std::string& where);

}  // namespace limber
