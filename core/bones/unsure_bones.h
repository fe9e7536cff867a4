// SPDX-License-Identifier: AGPL-3.0-or-later
// What the user should know of how the bones of a volume were told apart.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_parts.h"

namespace limber {

// One line for each label that follows a rig bone only because the rig has none for it, and one for the bones that
// touch so broadly that the place of the cut between them is not sure.
std::vector<std::string> unsure_bones(const BoneParts& parts, const TissueTable& tissues, const Armature& armature);

}  // namespace limber
