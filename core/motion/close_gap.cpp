// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/close_gap.h"

#include "core/base/error.h"
#include "core/motion/key_curve.h"

namespace limber {

std::vector<Pose> with_gap_closed(std::vector<Pose> poses, int first, int last) {
  const int before = first - 1, after = last + 1;
  if (first > last || before < 1 || after + 1 >= std::ssize(poses))
    throw Error("the gap cannot be closed", "frames " + std::to_string(first) + " to " + std::to_string(last),
                "leave at least two frames before the gap and two after it");
  const double frames = after - before;
  const Pose &a = poses[before], &b = poses[after], &a_earlier = poses[before - 1], &b_later = poses[after + 1];
  for (int frame = first; frame <= last; ++frame) {
    const double share = (frame - before) / frames;
    Pose& pose = poses[frame];
    for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone)
      pose.rotation[bone] =
          bezier_rotation(a.rotation[bone], turn_between(a_earlier.rotation[bone], a.rotation[bone]), b.rotation[bone],
                          turn_between(b.rotation[bone], b_later.rotation[bone]), frames, share);
    pose.root_translation =
        bezier_shift(a.root_translation, a.root_translation - a_earlier.root_translation, b.root_translation,
                     b_later.root_translation - b.root_translation, frames, share);
  }
  return poses;
}

}  // namespace limber
