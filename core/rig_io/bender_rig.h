// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes armatures of Bender (Kitware 2012-2014), a posing tool for label volumes. Its two formats are in
// RAS; x and y are negated to get LPS. (Read this way, every bone end of Bender's sample arm is inside the sample's
// tissue; without negation, none is.)
//
//   .vtk  legacy ASCII PolyData: one line of two points (head, tail) per bone, and cell arrays Parenthood (index of the
//         parent or -1) and Names. Transforms (12 numbers per bone), EnvelopeRadiuses and RestToPoseRotation are for
//         posing and display: they are skipped on reading, and written as at rest.
//   .arm  XML: nested <bone name head tail orientation>. Head and tail are relative to the parent's tail, in the
//         parent's own axes. Orientation (x y z w) rotates the bone's axes into its parent's; y is along the bone
//         [Blender, Bone.head].
#pragma once

#include <string>

#include "core/rig/armature.h"

namespace limber {

// Parse the text of an armature file. Throw Error with the line, and what to do.
//   where  names the text in error messages
Armature parse_bender_vtk(const std::string& text, const std::string& where);
Armature parse_bender_arm(const std::string& text, const std::string& where);

std::string bender_vtk_text(const Armature& armature);

}  // namespace limber
