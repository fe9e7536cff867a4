// SPDX-License-Identifier: AGPL-3.0-or-later
// A tet mesh as TetGen's text files NAME.node and NAME.ele, numbered from 0: the region of a tet is its one attribute
// (0 soft tissue, 1 + the rig bone; or an organ number), as TetGen, Gmsh, Geant4 and PHITS read it. Places are written
// so that reading gives them back bit for bit.
#pragma once

#include "core/base/file.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

//   name  with or without .node or .ele
//   throws Error when a file cannot be written
void write_tetgen_files(const Path& name, const TetMesh& mesh);

}  // namespace limber
