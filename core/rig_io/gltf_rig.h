// SPDX-License-Identifier: AGPL-3.0-or-later
// What a glTF 2.0 file (.gltf, or .glb with its data inside) holds: meshes, skins, animations, and the first skin's
// joints at rest as a rig. Y up in metres is turned to LPS mm.
//
// Only the description is read, not the vertex data, and it is read strictly: every property that the specification
// gives a type must have it, every reference must point at something, and the node graph must be a forest. Libraries
// that read whole models let such files pass and answer with an empty scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/rig/armature.h"

namespace limber {

struct GltfSummary {
  int nodes = 0, meshes = 0, skins = 0, animations = 0;
  std::int64_t vertices = 0, triangles = 0;  // of all meshes; triangle lists, strips and fans
  Armature armature;                         // of the first skin; no bones without one
  std::vector<std::string> warnings;
};

// `is_binary` for .glb. Throws Error with the property or the place that is wrong.
GltfSummary parse_gltf(const std::string& bytes, bool is_binary, const std::string& where);

}  // namespace limber
