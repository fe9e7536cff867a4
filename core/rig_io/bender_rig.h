// SPDX-License-Identifier: AGPL-3.0-or-later
// Armatures of Bender (Kitware 2012-2014), both kinds in RAS and turned to LPS by negating x and y: with it, every bone
// end of Bender's sample arm lies in tissue; without it, none.
//
//   .vtk  legacy ASCII PolyData: one line of two points (head, tail) per bone, and cell arrays Parenthood (place of the
//         parent or -1) and Names. Transforms (12 numbers per bone), EnvelopeRadiuses and RestToPoseRotation are about
//         posing and display: they are read past, and written as at rest.
//   .arm  XML: nested <bone name head tail orientation>. Head and tail are relative to the parent's tail, in the
//   parent's
//         own axes; orientation (x y z w) is the bone's axes in its parent's, y along the bone [Blender, Bone.head].
#pragma once

#include <string>

#include "core/rig/armature.h"

namespace limber {

// `where` names the text in errors. Throw Error with the place and what to do.
Armature parse_bender_vtk(const std::string& text, const std::string& where);
Armature parse_bender_arm(const std::string& text, const std::string& where);

std::string bender_vtk_text(const Armature& armature);

}  // namespace limber
