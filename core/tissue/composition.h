// SPDX-License-Identifier: AGPL-3.0-or-later
// What tissues are made of, for the transport of particles: shares of elements by mass from a table of comma-separated
// values, a row a medium with its source (assets/tissues/composition.csv: the media of ICRP Publication 110, 2009, and
// a metal).
// Which medium a tissue is of stands in tissues.csv (tissue_rows.h); each mixture there is a medium of its own behind
// them, by the masses of its parts.
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
// The elements of ICRP Publication 110 in its order, then those of implants.
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

// Throws Error naming file and line.
CompositionTable read_composition_table();

// The row of each tissue of the table, in its order. Throws Error naming the tissues that have none: `where` is the
// file.
std::vector<int> media_of(const TissueTable& tissues, const CompositionTable& media, const std::string& where);

}  // namespace limber
