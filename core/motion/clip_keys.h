// SPDX-License-Identifier: AGPL-3.0-or-later
// Deletes keys of a whole clip. Where the weight of a constraint loses all its keys, the constraint keeps the weight of
// the last of them, so that its deletion does not switch it on or off.
#pragma once

#include <set>
#include <string>

#include "core/motion/clip.h"

namespace limber {

// Deletes all keys at the given frames.
void delete_clip_keys(Clip& clip, const std::set<int>& frames);
// Deletes all keys outside of a range of frames. Weights play in the range as before: they are keyed at an end of it
// beyond which they had keys.
void delete_clip_keys_outside(Clip& clip, int low, int high);

}  // namespace limber
