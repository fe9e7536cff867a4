// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads which elements tissues consist of, for particle transport simulations. The table assets/tissues/composition.csv
// has one row per medium, with the elements' shares by mass and their source; it contains the media of ICRP Publication
// 110 (2009) and metals. tissues.csv (tissue_rows.h) names the medium of each tissue. Each mixture in tissues.csv
// becomes an additional medium after the others, composed by the masses of its parts.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/tissue/tissue_match.h"

namespace limber {

struct Element {
  const char* symbol;
  int atomic_number;
};
// The elements of the composition table: the 13 of ICRP Publication 110 in its order, then those of implants.
inline constexpr std::size_t kTissueElements = 13;
inline constexpr std::array<Element, 16> kElements = {{{"H", 1},
                                                       {"C", 6},
                                                       {"N", 7},
                                                       {"O", 8},
                                                       {"Na", 11},
                                                       {"Mg", 12},
                                                       {"P", 15},
                                                       {"S", 16},
                                                       {"Cl", 17},
                                                       {"K", 19},
                                                       {"Ca", 20},
                                                       {"Fe", 26},
                                                       {"I", 53},
                                                       {"Al", 13},
                                                       {"Ti", 22},
                                                       {"V", 23}}};
using Composition = std::array<double, kElements.size()>;  // shares by mass, sum 1

struct CompositionTable {
  std::vector<TissueNames> names;    // #rows
  std::vector<Composition> shares;   // #rows
  std::vector<std::string> sources;  // #rows
};

// Reads the program's composition table. Throws Error, which names file and line, when a row is not valid.
CompositionTable read_composition_table();

// Returns the index in `media` of each tissue's medium, in the order of the tissues. Throws Error, which names the
// tissues without a medium and `where` (the file).
std::vector<int> media_of(const TissueTable& tissues, const CompositionTable& media, const std::string& where);

}  // namespace limber
