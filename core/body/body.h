// SPDX-License-Identifier: AGPL-3.0-or-later
// A body: a label volume, its tissues, and the rig that poses it. The command line and the Python module both make
// bodies here, so that they agree on which labels are bone and skin and give the same warnings.
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
  // One line for each label that was assumed to be bone or skin because no table says so, then the doubts.
  std::vector<std::string> warnings;
};

// Makes a body. If no table says which labels are bone or skin, guesses them.
//   table     the user's tissue table; nullptr: the descriptions in the volume's file are used
//   bones     labels of bone, as values in the volume's file; empty: the table names them, or they are guessed
//   where     names the volume in messages
//   throws    Error if `bones` has a value that the volume lacks
Body make_body(VolumeFile file, const TissueTable* table, Armature rig, const std::vector<double>& bones, BoneMap map,
               const std::string& where);

}  // namespace limber
