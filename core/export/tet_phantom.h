// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the list of materials for a tet mesh whose regions are organ numbers (TetGen's .node and .ele), as in the
// phantoms of ICRP Publication 145. Each organ has a line `C NAME DENSITY g/cm3`, then a line `mNUMBER` and a line per
// chemical element with two numbers: 1000 x atomic number, and the share by mass, negative. This is MCNP's format of
// materials. Geant4's ICRP145_HumanPhantoms reads the file unchanged, and PHITS accepts the same lines in its input.
#pragma once

#include <string>
#include <vector>

#include "core/mesh/tet_mesh.h"
#include "core/tissue/composition.h"

namespace limber {

// Returns the organ number of a tissue's tets: the tissue's file value when it is from 1 to 65535, else its label.
std::uint16_t organ_number(const Tissue& tissue);

// Returns the tet mesh of nodes V and tets T in which a tet's region is the number of its organ.
//   V       node positions, world, mm
//   labels  #T: the most frequent label in each tet. 0: the tet contains no tissue voxel; it gets the organ of a tet
//           that shares a node with it
TetMesh organ_mesh(const Eigen::MatrixX3d& V, const Eigen::MatrixX4i& T, const std::vector<Label>& labels,
                   const TissueTable& tissues);

// Returns the text of the list of materials. Throws Error, which names the tissues, if the chemical elements of tissues
// are unknown.
//   organs  organ numbers in the mesh
//   where   the file, for the error message
std::string material_list(const TissueTable& tissues, const std::vector<std::uint16_t>& organs,
                          const CompositionTable& media, const std::string& where);

// Returns the text of colour.dat, which Geant4's ICRP145_HumanPhantoms reads: for each organ a line with its number and
// its colour's red, green, blue and opacity, [0, 1]. Skin is nearly transparent, so that the organs are seen.
std::string colour_list(const TissueTable& tissues, const std::vector<std::uint16_t>& organs);

}  // namespace limber
