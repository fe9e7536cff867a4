// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the surface of a rigid object, such as an obstacle, from a file of another program:
//   .stl          binary and ASCII
//   .obj          the vertices and faces of all groups
//   .ply          ASCII and binary of both byte orders; other elements and properties are skipped
//   .gltf, .glb   all meshes of the default scene, placed by their nodes; skins and morph targets are not applied
// STL, OBJ and PLY say neither unit nor axes: their numbers are taken as world (LPS), mm, as
// core/export/surface_files.h writes them. glTF's metres with Y up are converted to these. Polygons are split into fans
// of triangles. Corners at equal positions become one vertex, since STL has no other way to say that triangles are
// neighbours. Triangles without area, and vertices that no triangle uses, are left out.
//
// Files are not trusted. No count in a file leads to more memory than the bytes of the file justify, and files that
// a .gltf names are read only from its own folder and the folders below.
#pragma once

#include <string>

#include "core/base/file.h"
#include "core/mesh/surface.h"

namespace limber {

constexpr std::size_t kMostSurfaceTriangles = 2'000'000;
constexpr std::uint64_t kMostSurfaceBytes = std::uint64_t{1} << 30;  // 2 million triangles in ASCII STL take about half
constexpr double kFarthestSurfacePoint = 1e6;                        // mm along each axis: a kilometre
constexpr const char* kSurfaceFileEndings = ".stl, .obj, .ply, .glb or .gltf";

// Throws Error if the file cannot be read, is damaged, has no triangle with an area, has more than
// kMostSurfaceTriangles, or has a point that is not finite or beyond kFarthestSurfacePoint.
TriangleMesh read_surface(const Path& path);

// Parses the bytes of a file.
//   path  names the format by its extension, the file in error messages, and the folder of files that a .gltf names
TriangleMesh parse_surface(const std::string& bytes, const Path& path);

}  // namespace limber
