// SPDX-License-Identifier: AGPL-3.0-or-later
// The list of materials that belongs to a tet mesh with organ numbers (TetGen's .node and .ele), as the phantoms of ICRP Publication
// 145 have it: per organ a line `C NAME DENSITY g/cm3`, then `mNUMBER` with pairs of 1000 x atomic number and minus the share by mass.
// That is MCNP's form of a material; Geant4's ICRP145_HumanPhantoms reads the file as it is, PHITS takes the same cards.
#pragma once

#include <string>
#include <vector>

#include "core/volume/composition.h"

namespace limber {

// What a tet of a tissue carries: the label in files where that is a number from 1 to 65535, else the label here.
std::uint16_t organ_number(const Tissue& tissue);

//   organs  numbers that the mesh has
//   throws Error naming the tissues whose elements are not known: `where` is the file
std::string material_list(const TissueTable& tissues, const std::vector<std::uint16_t>& organs, const CompositionTable& media, const std::string& where);

}  // namespace limber
