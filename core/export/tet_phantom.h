// SPDX-License-Identifier: AGPL-3.0-or-later
// The list of materials that belongs to a tet mesh with organ numbers (TetGen's .node and .ele), as the phantoms of
// ICRP Publication 145 have it: per organ a line `C NAME DENSITY g/cm3`, then `mNUMBER` with pairs of 1000 x atomic
// number and minus the share by mass. That is MCNP's form of a material; Geant4's ICRP145_HumanPhantoms reads the file
// as it is, PHITS takes the same cards.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/tet_mesh.h"
#include "core/tissue/composition.h"

namespace limber {

// What a tet of a tissue carries: the label in files where that is a number from 1 to 65535, else the label here.
std::uint16_t organ_number(const Tissue& tissue);

// A mesh with organ numbers as regions.
//   V, T    places, world, mm; tets
//   labels  #T of most of what a tet holds; 0: it holds no voxel, and becomes as a tet that shares a corner
TetMesh organ_mesh(const Eigen::MatrixX3d& V, const Eigen::MatrixX4i& T, const std::vector<Label>& labels,
                   const TissueTable& tissues);

//   organs  numbers that the mesh has
//   throws Error naming the tissues whose elements are not known: `where` is the file
std::string material_list(const TissueTable& tissues, const std::vector<std::uint16_t>& organs,
                          const CompositionTable& media, const std::string& where);

}  // namespace limber
