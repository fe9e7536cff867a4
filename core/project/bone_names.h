// SPDX-License-Identifier: AGPL-3.0-or-later
// Updates a document after bones were renamed or mirrored. The document stores some data by bone name: keys,
// constraints, library poses, the source joints of clips, pins, pole targets, weight locks and the bone map. Some clips
// match joints to bones by their names alone. If the new names would change this match, the clip stores its previous
// joint, rest offset and scale, so that it keeps its motion. A bone that had no joint, and whose new name matches a
// joint, follows that joint from then on.
#pragma once

#include "core/project/document.h"

namespace limber {

// Moves the data of every renamed bone to its new name. The data of a removed bone are dropped when another bone takes
// its name.
//   before, after  the rig before and after the edit, with the same bones in the same order
void follow_names(Document& document, const Armature& before, const Armature& after);

// Updates the document after mirrored_bones() mirrored `bones`; both armatures list the bones in the same order. When a
// bone of the left or right side did not swap names with its counterpart, its data move to its new name. Its pose,
// keys, library poses and pole targets are mirrored as well.
void follow_mirrored(Document& document, const Armature& before, const Armature& after, const std::vector<int>& bones);

}  // namespace limber
