// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes warnings about uncertain results of separating bone tissue into bones.
#pragma once

#include <string>
#include <vector>

#include "core/bones/bone_parts.h"

namespace limber {

// Returns one line for each label that follows a substitute bone because the rig has no bone that matches its name, and
// one line about all pairs of bones that touch so broadly that the cut between them is uncertain.
std::vector<std::string> unsure_bones(const BoneParts& parts, const TissueTable& tissues, const Armature& armature);

}  // namespace limber
