// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a tet mesh as TetGen's text files NAME.node and NAME.ele, which TetGen, Gmsh, Geant4 and PHITS read. Nodes and
// tets are numbered from 0. Each tet has one attribute, its region. In a solver's mesh the region is 0 for soft tissue
// and 1 + the index of the rig bone for bone; in a phantom it is an organ number (tet_phantom.h). Positions are written
// with enough digits to be read back bit for bit.
#pragma once

#include "core/base/file.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

// Writes NAME.node and NAME.ele. Throws Error when one of them cannot be written.
//   name  path NAME, NAME.node or NAME.ele
void write_tetgen_files(const Path& name, const TetMesh& mesh);

}  // namespace limber
