// SPDX-License-Identifier: AGPL-3.0-or-later
// Deletes keys of a whole clip. If all keys of a constraint's weight are deleted, the constraint keeps the weight of
// the last key as its constant weight, so that deleting the keys does not switch it on or off.
#pragma once

#include <set>
#include <string>

#include "core/motion/clip.h"

namespace limber {

// Deletes all keys at the given frames.
void delete_clip_keys(Clip& clip, const std::set<int>& frames);
// Deletes all keys outside of a range of frames. The weights of constraints stay as they were within the range: where a
// weight had keys beyond an end of the range, it gets a key at this end.
void delete_clip_keys_outside(Clip& clip, int low, int high);

}  // namespace limber
