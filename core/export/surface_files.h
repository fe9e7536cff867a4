// SPDX-License-Identifier: AGPL-3.0-or-later
// Surfaces of tissues as files: Wavefront OBJ, all tissues in one file as groups that share their vertices; glTF
// (.glb), all in one file, a node with a name and a colour each; STL (binary) and PLY (binary, with the tissue's
// colour), a file a tissue. World coordinates (LPS), millimetres; those of glTF are its own [glb_writer.h].
#pragma once

#include <string>
#include <vector>

#include "core/mesh/label_surfaces.h"
#include "core/tissue/tissue_table.h"

namespace limber {

bool is_surface_path(const Path& path);  // .obj, .glb, .stl, .ply
constexpr const char* kSurfaceEndings = ".obj, .glb, .stl or .ply";

// What is written for OUT: OUT itself, or NAME-TISSUE.stl for each surface, in its order.
std::vector<Path> surface_paths(const LabelSurfaces& all, const TissueTable& tissues, const Path& path);

// Throws Error when a file cannot be written; files of other tissues that were written before it then remain.
void write_surfaces(const LabelSurfaces& all, const TissueTable& tissues, const Path& path);

}  // namespace limber
