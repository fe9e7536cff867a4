// SPDX-License-Identifier: AGPL-3.0-or-later
// Follows the centre of a body that a clip moves, for a camera that keeps this centre at one place of the picture. The
// centre is the head of the pelvis, or of the first bone without a parent. It is smoothed by a Gaussian over time, so
// that the camera goes along with a walk but does not take up its bouncing and swaying.
#pragma once

#include <map>
#include <memory>

#include "core/motion/clip.h"

namespace limber {

class FollowedCentre {
 public:
  FollowedCentre(std::shared_ptr<const Clip> clip, std::shared_ptr<const Armature> armature);

  // Returns the smoothed centre at a frame, mm. Only frames range_start to range_end of the clip count; a frame outside
  // of them has the centre of the nearest one.
  glm::dvec3 at(int frame);
  // Returns the unsmoothed centre in any pose, mm. The pose need not belong to the clip.
  glm::dvec3 in_pose(const Pose& pose) const;

 private:
  const glm::dvec3& measured(int frame);
  // Extends the path of the centre beyond the ends of the range by a point reflection at each end. So a walk keeps its
  // speed at the ends.
  glm::dvec3 extended(int frame);

  const ClipOnRig clip_;
  int bone_ = 0, first_ = 0, last_ = 0;
  double deviation_ = 1;  // standard deviation of the Gaussian, frames
  std::map<int, glm::dvec3> measured_;
};

}  // namespace limber
