// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads rigs from files and writes them.
//
//   .json  Limber's own: {"space": "LPS", "unit": "mm", "bones": [{"name", "parent": name | null, "head": [3],
//          "tail": [3], "roll"?: radians, "limits"?: LIMITS}]}. Space RAS and units cm and m are converted to LPS mm on
//          reading. Bones may be in any order; they are sorted to have parents before children. LIMITS is one of
//            {"type": "free"}   {"type": "fixed"}
//            {"type": "hinge", "axis": [3], "minimum_degrees": d, "maximum_degrees": d}
//            {"type": "ball", "axis"?: [3] (the twist axis), "cone_degrees": d, "twist_minimum_degrees": d,
//             "twist_maximum_degrees": d}
//   .vtk   Bender's armatures, converted from RAS mm to LPS (core/rig_io/bender_rig.h)
//   .arm   the XML of Bender's Blender script, also converted from RAS mm to LPS; read only
//   .bvh   the hierarchy at rest as a rig: Y up, converted to LPS by (x, -z, y); the file's unit is taken as mm
//   .gltf, .glb  the joints of the first skin at rest: Y up in metres, converted to LPS mm; read only
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/rig/armature.h"

namespace limber {

struct ArmatureFile {
  Armature armature;
  std::string format;  // name of the file's format: "Limber JSON", "Bender VTK", "Bender ARM", "BVH", "glTF"
  std::vector<std::string> warnings;
};

// Reads a rig; the path's extension tells the format. Throws Error with the file, the line or bone, and what to do.
ArmatureFile read_armature_file(const Path& path);
inline Armature read_armature(const Path& path) { return read_armature_file(path).armature; }

// Parses a rig in Limber's JSON format.
//   where  names the text in error messages
Armature parse_armature_json(const std::string& text, const std::string& where);

// Writes a rig; the path's extension tells the format. A .json file keeps everything. Files .vtk and .bvh keep names,
// parents, heads and tails; .bvh stores a tail as the first child's offset or as an End Site. Throws Error for other
// extensions.
void write_armature(const Armature& armature, const Path& path);
// Throws Error if no rig can be written to this path.
void check_armature_writable(const Path& path);

}  // namespace limber
