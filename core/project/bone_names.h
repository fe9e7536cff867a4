// SPDX-License-Identifier: AGPL-3.0-or-later
// Bones that change their names keep what is theirs: keys, poses of the library, the joints that move them, pins and
// poles, locks of their weights. A clip that was matched by names goes on as it did: where the new names alone would no
// longer say so, what moved a bone, how it was turned and how far the body travelled is written down in the clip. A
// bone that was not moved and now has a name that the motion knows is moved by it.
#pragma once

#include "core/project/document.h"

namespace limber {

//   before, after  the same bones in the same order. What the document has under a new name of another, removed bone
//   goes.
void follow_names(Document& document, const Armature& before, const Armature& after);

// After `bones` were mirrored (mirrored_bones), each in its place in the list: those that went to the other side alone
// do what they did in the mirror, under the name that they have now: in pose, keys and library, with their pins, poles
// and locks.
void follow_mirrored(Document& document, const Armature& before, const Armature& after, const std::vector<int>& bones);

}  // namespace limber
