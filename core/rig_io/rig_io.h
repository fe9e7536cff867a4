// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigs from and to files.
//
//   .json  ours: {"space": "LPS", "unit": "mm", "bones": [{"name", "parent": name | null, "head": [3], "tail": [3],
//          "roll"?: radians, "limits"?: LIMITS}]}. Space RAS and units cm and m are turned to LPS mm on reading. Bones
//          may stand in any order; parents are put before their children. LIMITS is one of
//            {"type": "free"}   {"type": "fixed"}
//            {"type": "hinge", "axis": [3], "minimum_degrees": d, "maximum_degrees": d}
//            {"type": "ball", "axis"?: [3] (of twist), "cone_degrees": d, "twist_minimum_degrees": d,
//            "twist_maximum_degrees": d}
//   .vtk   Bender's armatures, RAS mm turned to LPS (core/rig_io/bender_rig.h)
//   .arm   the XML that Bender's Blender script wrote, turned the same way
//   .bvh   the hierarchy at rest as a rig: Y up, turned to LPS by (x, -z, y), in the file's own unit taken as mm
//   .gltf  .glb: the joints of the first skin at rest: Y up in metres, turned to LPS mm; read only
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/rig/armature.h"

namespace limber {

struct ArmatureFile {
  Armature armature;
  std::string format;  // "Limber JSON", "Bender VTK", "Bender ARM", "BVH", "glTF"
  std::vector<std::string> warnings;
};

// By extension and content. Throws Error with file, place and what to do.
ArmatureFile read_armature_file(const Path& path);
inline Armature read_armature(const Path& path) { return read_armature_file(path).armature; }

// The same from a text that was read already; `where` names it in errors.
Armature parse_armature_json(const std::string& text, const std::string& where);

// By extension: .json keeps everything; .vtk keeps names, parents, heads and tails; .bvh the same, with tails as the
// first child's offset or as an End Site. Throws Error for another extension.
void write_armature(const Armature& armature, const Path& path);
// Throws Error when no rig can be written under this name.
void check_armature_writable(const Path& path);

}  // namespace limber
