// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a tet mesh as TetGen's text files NAME.node and NAME.ele, which TetGen, Gmsh, Geant4 and PHITS read. Nodes and
// tets are numbered from 0. A tet's only attribute is its region: 0 for soft tissue, 1 + the index of the rig bone, or
// an organ number. Positions are written with enough digits to be read back bit for bit.
#pragma once

#include "core/base/file.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

// Writes NAME.node and NAME.ele. Throws Error when one of them cannot be written.
//   name  path NAME, NAME.node or NAME.ele
void write_tetgen_files(const Path& name, const TetMesh& mesh);

}  // namespace limber
