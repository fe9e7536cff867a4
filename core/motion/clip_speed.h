// SPDX-License-Identifier: AGPL-3.0-or-later
// Changes the number of frames of a clip: its rate at the same speed, or its speed at the same rate.
#pragma once

#include "core/base/progress.h"
#include "core/motion/clip.h"

namespace limber {

constexpr double kSlowest = 0.05, kFastest = 20;  // smallest and largest factor of at_speed(); others throw Error

// Returns the clip resampled to another rate, in frames per second. Keys, markers and the playing range get new frame
// numbers, so that they stay at the same time.
Clip at_rate(const Clip& clip, double rate);

// Returns the clip that plays `factor` times as fast at the same rate: the motion is resampled by slerp, and keys,
// handles, markers and the playing range keep their places in the motion, to the nearest frame. The clip's frame
// `start` stays. Throws Error for a factor outside [kSlowest, kFastest], and Cancelled.
Clip at_speed(const Clip& clip, double factor, Progress& progress = no_progress());
// Returns the poses resampled so that they play `factor` times as fast. The first pose stays. The new duration is the
// old one divided by `factor`, rounded down to whole frames.
std::vector<Pose> at_speed(const std::vector<Pose>& poses, double factor);

}  // namespace limber
