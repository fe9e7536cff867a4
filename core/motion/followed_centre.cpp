// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/followed_centre.h"

#include <algorithm>
#include <cmath>

#include "core/motion/body_frame.h"
#include "core/motion/posed_rig.h"

namespace limber {

namespace {

// Standard deviation of the Gaussian, seconds. A step takes about half a second, so its bounce is smoothed away.
constexpr double kDeviation = 0.25;
constexpr double kMostFrames = 1000;  // upper limit on the standard deviation, frames; needed for very high rates
constexpr int kReach = 3;             // standard deviations after which the Gaussian is cut off

int centre_bone(const Armature& armature) {
  const Skeleton skeleton = skeleton_of(armature);
  const auto pelvis = skeleton.joint.find({BodyPart::Pelvis});
  if (pelvis != skeleton.joint.end()) return pelvis->second;
  const auto root =
      std::find_if(armature.bones.begin(), armature.bones.end(), [](const Bone& bone) { return bone.parent < 0; });
  return static_cast<int>(root - armature.bones.begin());
}

}  // namespace

FollowedCentre::FollowedCentre(std::shared_ptr<const Clip> clip, std::shared_ptr<const Armature> armature)
    : clip_(clip, armature),
      bone_(centre_bone(*armature)),
      first_(clip->range_start),
      last_(std::max(clip->range_start, clip->range_end)),
      deviation_(std::clamp(kDeviation * clip->rate, 0.01, kMostFrames)) {}

const glm::dvec3& FollowedCentre::measured(int frame) {
  const auto known = measured_.find(frame);
  if (known != measured_.end()) return known->second;
  return measured_.emplace(frame, in_pose(clip_.at(frame))).first->second;
}

glm::dvec3 FollowedCentre::in_pose(const Pose& pose) const { return PosedRig(*clip_.armature(), pose).head(bone_); }

glm::dvec3 FollowedCentre::extended(int frame) {
  if (frame >= first_ && frame <= last_) return measured(frame);
  const int end = frame < first_ ? first_ : last_;
  return 2.0 * measured(end) - measured(2 * end - frame);
}

glm::dvec3 FollowedCentre::at(int frame) {
  frame = std::clamp(frame, first_, last_);
  const int reach = std::min(static_cast<int>(std::ceil(kReach * deviation_)), last_ - first_);
  glm::dvec3 sum(0);
  double weights = 0;
  for (int offset = -reach; offset <= reach; ++offset) {
    const double weight = std::exp(-0.5 * (offset / deviation_) * (offset / deviation_));
    sum += weight * extended(frame + offset);
    weights += weight;
  }
  return sum / weights;
}

}  // namespace limber
