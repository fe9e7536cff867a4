// SPDX-License-Identifier: AGPL-3.0-or-later
// Rigs from and to files: our JSON, Bender's .vtk and .arm (RAS, turned to LPS by negating x and y), BVH hierarchies
// (Y up, turned to LPS by (x, -z, y); only as a rig, no motion), glTF skins for looking (read only).
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

// By extension: .json, .vtk, .bvh.
void write_armature(const Armature& armature, const Path& path);

}  // namespace limber
