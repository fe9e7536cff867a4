// SPDX-License-Identifier: AGPL-3.0-or-later
// Removes jitter from a take by a low-pass filter over its poses.
#pragma once

#include <vector>

#include "core/rig/pose.h"

namespace limber {

// Returns the poses with all movement faster than `cutoff` filtered out. A Butterworth filter of second order runs
// forwards and then backwards over the frames, so nothing lags behind [Winter 2009, Biomechanics and Motor Control of
// Human Movement, section 3.4.4]; its cutoff is corrected for the two passes. Rotations are filtered as quaternions
// with consistent signs and normalized again.
//   rate    frames per second
//   cutoff  Hz; throws Error unless it is positive and below two fifths of the rate
std::vector<Pose> smoothed(const std::vector<Pose>& poses, double rate, double cutoff);

}  // namespace limber
