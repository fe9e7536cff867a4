// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the surface of a rigid object, such as an obstacle, from a file of another program:
//   .stl          binary and ASCII
//   .obj          the vertices and faces of all groups
//   .ply          ASCII and binary of both byte orders; other elements and properties are skipped
//   .gltf, .glb   all meshes of the default scene, with their nodes' transforms; without skins and morph targets
// STL, OBJ and PLY contain neither unit nor axes: their numbers are read as world coordinates (LPS) in mm, as written
// by core/export/surface_files.h. glTF's metres with Y up are converted to these. Polygons are split into fans of
// triangles. Corners at equal positions become one vertex, since STL has no other way to say that triangles are
// neighbours. Triangles without area, and vertices that no triangle uses, are left out.
//
// Files are not trusted. No count in a file makes the reader use more memory than the bytes of the file justify, and
// files that a .gltf names are read only from its own folder and the folders below.
#pragma once

#include <string>

#include "core/base/file.h"
#include "core/mesh/surface.h"

namespace limber {

constexpr std::size_t kMostSurfaceTriangles = 2'000'000;
// Larger files are refused, bytes. kMostSurfaceTriangles triangles in ASCII STL take about half of this size.
constexpr std::uint64_t kMostSurfaceBytes = std::uint64_t{1} << 30;
constexpr double kFarthestSurfacePoint = 1e6;  // a file with a larger coordinate is refused, mm (1 km)
constexpr const char* kSurfaceFileEndings = ".stl, .obj, .ply, .glb or .gltf";

// Throws Error if the file cannot be read, is damaged, has no triangle with an area, has more than
// kMostSurfaceTriangles, or has a point that is not finite or beyond kFarthestSurfacePoint.
TriangleMesh read_surface(const Path& path);

// Parses the bytes of a file.
//   path  path of the file: gives the format by its extension, the name for error messages, and the folder in which
//         files that a .gltf names are searched
TriangleMesh parse_surface(const std::string& bytes, const Path& path);

}  // namespace limber
