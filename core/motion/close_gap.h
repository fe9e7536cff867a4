// SPDX-License-Identifier: AGPL-3.0-or-later
// Replaces bad frames of a recorded motion by a smooth bridge, for example frames in which a capture marker was hidden.
#pragma once

#include <vector>

#include "core/rig/pose.h"

namespace limber {

// Returns the poses with the frames `first` to `last` replaced. Each bone, and the body's shift, follows a cubic Bezier
// curve from the frame before to the frame after (core/motion/key_curve.h), whose speeds at both ends are those of the
// motion outside of the gap: the differences of the two frames before and of the two frames after.
//   throws Error unless 0 <= first <= last, and at least two frames lie before the gap and two after it
std::vector<Pose> with_gap_closed(std::vector<Pose> poses, int first, int last);

}  // namespace limber
