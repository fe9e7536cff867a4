// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the chemical elements of tissues, for particle transport simulations. The table assets/tissues/composition.csv
// has one row per medium (material of tissues), with the elements' shares by mass and their source; it contains the
// media of ICRP Publication 110 (2009) and metals. tissues.csv (tissue_rows.h) names the medium of each tissue. Each
// mixture in tissues.csv becomes an additional medium after the others, composed by the masses of its parts.
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
// The elements of the composition table: the 13 elements of ICRP Publication 110 in its order, then those of implants.
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
using Composition = std::array<double, kElements.size()>;  // share of each element by mass; the sum is 1

struct CompositionTable {
  std::vector<TissueNames> names;    // names of the medium in each row
  std::vector<Composition> shares;   // composition of the medium in each row
  std::vector<std::string> sources;  // source of the composition in each row
};

// Reads the program's composition table. If a row is not valid, throws Error, which names the file and the line.
CompositionTable read_composition_table();

// Returns for each tissue, in the order of `tissues`, the index of its medium in `media`. If tissues have no medium,
// throws Error, which names these tissues and `where` (the file).
std::vector<int> media_of(const TissueTable& tissues, const CompositionTable& media, const std::string& where);

}  // namespace limber
