// SPDX-License-Identifier: AGPL-3.0-or-later
// A body: a label volume, its tissues, and the rig that poses it. The command line and the Python module make bodies
// here, so that both take the same tissue for bone and for skin, and doubt the same inputs.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_identity.h"
#include "core/rig/armature.h"
#include "core/volume_io/volume_io.h"

namespace limber {

struct Body {
  VolumeFile file;
  TissueTable tissues;
  Armature rig;
  BoneMap bone_map;                 // the rig bones that the user assigned to labels
  std::vector<std::string> doubts;  // signs that the inputs are not of the same body (input_doubts.h)
  // One line for each tissue that was taken for bone or skin because no table says so, then the doubts.
  std::vector<std::string> warnings;
};

// Makes a body. If no table says what is bone or skin, finds the label that looks like it.
//   table     the user's tissue table; nullptr: the volume's own descriptions count
//   bones     labels of bone, as values in the volume's file; empty: the table tells, or the label is found
//   where     names the volume in messages
//   throws    Error if `bones` has a value that the volume lacks
Body make_body(VolumeFile file, const TissueTable* table, Armature rig, const std::vector<double>& bones, BoneMap map,
               const std::string& where);

}  // namespace limber
