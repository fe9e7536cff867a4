// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the surfaces of tissues as files. An OBJ file has all tissues, as groups that share their vertices. A .glb
// file (glTF) has all tissues, with a named and coloured node per tissue. STL (binary) and PLY (binary, with the
// tissue's colour) have one file per tissue. Coordinates are world (LPS), mm, except in glTF, which has its own
// (glb_writer.h).
#pragma once

#include <string>
#include <vector>

#include "core/mesh/label_surfaces.h"
#include "core/tissue/tissue_table.h"

namespace limber {

bool is_surface_path(const Path& path);  // accepts .obj, .glb, .stl, .ply
constexpr const char* kSurfaceEndings = ".obj, .glb, .stl or .ply";

// Returns the files that write_surfaces() writes: `path` itself, or for STL and PLY one file NAME-TISSUE.stl (.ply) per
// surface, in the order of the surfaces.
std::vector<Path> surface_paths(const LabelSurfaces& all, const TissueTable& tissues, const Path& path);

// Writes the surfaces. Throws Error when a file cannot be written; files that were completely written before stay.
void write_surfaces(const LabelSurfaces& all, const TissueTable& tissues, const Path& path);

}  // namespace limber
