// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds inputs that do not belong together, before anything is computed from them: a grey image read as labels, a rig
// outside the body or mirrored, a rig whose left is the body's right, a rig of another limb, or a label of one bone
// that is along another bone. Each doubt is one sentence that says what is wrong and what to do.
#pragma once

#include <string>
#include <vector>

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"

namespace limber {

// Returns the share of the rig's length that is in tissue, [0, 1]. A tenth of each bone at both ends, near the joints,
// is not examined.
double share_in_tissue(const LabelVolume& volume, const Armature& armature);

std::vector<std::string> input_doubts(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature);

}  // namespace limber
