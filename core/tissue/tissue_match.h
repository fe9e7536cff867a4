// SPDX-License-Identifier: AGPL-3.0-or-later
// Which row of a table of tissue properties a tissue is: by the words of its name, else by its kind.
#pragma once

#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/tissue/tissue_table.h"

namespace limber {

// Lower-case words of a name: "vertebrae_C1", "BoneMarrow" and "tendon/ligament" are two words each.
using TissueWords = std::set<std::string, std::less<>>;
TissueWords words_in_tissue_name(std::string_view name);
// Whether the word, or its singular, is among them.
bool has_word(const TissueWords& words, std::string_view word);

struct TissueNames {
  std::string name;
  std::vector<std::string> synonyms;  // each one word or several; a tissue is meant whose name holds all of them
  std::vector<TissueKind> kinds;      // taken for tissues of these kinds that no name fits
  std::vector<TissueWords> words;     // of the name, then of each synonym
  std::vector<bool> whole = {};       // #words: the synonym, written "=head", must be all words of the tissue's name
  bool is_bone = false;               // by its own name: a muscle, named after the bone it hangs on, is never this row
};

struct TissueMatch {
  int row = -1;          // -1: none
  bool by_name = false;  // else by kind
  std::string words;     // the name or synonym that was found in the tissue's name
};

// The row whose synonym has most words of the tissue's name; of several the one that fits its kind, then the first.
TissueMatch match_tissue(const Tissue& tissue, std::span<const TissueNames> rows);
//   names  of a row, 0 .. rows - 1
TissueMatch match_tissue(const Tissue& tissue, std::size_t rows,
                         const std::function<const TissueNames&(std::size_t)>& names);

// Fields of a line of comma-separated values; a field in double quotes may hold commas, "" in it is one quote.
std::vector<std::string> csv_fields(std::string_view line);
std::string csv_field(const std::string& text);  // quoted where it has to be

// The columns `name,names,kinds` of such a table. Throws Error for a kind that is none.
TissueNames tissue_names_of(const std::vector<std::string>& fields, const std::string& where);

}  // namespace limber
