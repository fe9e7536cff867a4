// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the contents of a glTF 2.0 file (.gltf, or .glb with its data inside): the numbers of meshes, skins and
// animations, and the joints of the first skin at rest as a rig. Positions are converted from metres with Y up to LPS
// mm.
//
// Only the JSON description is read, not the vertex data. It is read strictly: every property must have the type that
// the specification gives it, every reference must have a target, and the node graph must be a forest. Libraries that
// read whole models accept wrong files and return an empty scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/rig/armature.h"

namespace limber {

struct GltfSummary {
  int nodes = 0, meshes = 0, skins = 0, animations = 0;
  std::int64_t vertices = 0, triangles = 0;  // sums over all meshes; triangles in lists, strips and fans
  Armature armature;                         // the joints of the first skin; no bones if there is no skin
  std::vector<std::string> warnings;
};

// Parses the bytes of a glTF file. Throws Error if a property is wrong or missing, and names this property.
//   is_binary  true for .glb
//   where      names the file in error messages
GltfSummary parse_gltf(const std::string& bytes, bool is_binary, const std::string& where);

}  // namespace limber
