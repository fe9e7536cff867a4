// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the surfaces of tissues. An OBJ file contains all tissues, as groups whose vertices are shared. A .glb file
// (glTF) contains all tissues, each as a named and coloured node. For STL (binary) and PLY (binary, with the tissue's
// colour) each tissue is a file of its own. Coordinates are world (LPS), mm, except in glTF, which defines other axes
// and units (glb_writer.h).
#pragma once

#include <string>
#include <vector>

#include "core/mesh/label_surfaces.h"
#include "core/tissue/tissue_table.h"

namespace limber {

bool is_surface_path(const Path& path);  // true for .obj, .glb, .stl, .ply
constexpr const char* kSurfaceEndings = ".obj, .glb, .stl or .ply";

// Returns the paths of the files that write_surfaces() writes: `path`, or for STL and PLY one file NAME-TISSUE.stl
// (.ply) per surface, in the order of the surfaces.
std::vector<Path> surface_paths(const LabelSurfaces& all, const TissueTable& tissues, const Path& path);

// Writes the surfaces. Throws Error if a file cannot be written; the files that have been completed until then stay.
void write_surfaces(const LabelSurfaces& all, const TissueTable& tissues, const Path& path);

}  // namespace limber
