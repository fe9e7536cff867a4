// SPDX-License-Identifier: AGPL-3.0-or-later
// Baked joints (deform/baked_joint.h) in a pose of the rig.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/deform/baked_flesh.h"
#include "core/rig/pose.h"

namespace limber {

using BakedJoints = std::vector<std::shared_ptr<const BakedJoint>>;

// How a pose uses a baked joint.
struct BakedJointReport {
  std::string bone;
  double degrees = 0;            // turn about the baked axis
  double low = 0, high = 0;      // range of the baked angles, degrees; turns beyond count as its end
  double other_degrees = 0;      // turn about other axes, which the baked shifts know nothing of
  std::vector<double> baked_at;  // degrees
  BakeError worst_between;       // the largest error that was found between baked angles
  std::string glide;             // how joints glided when it was baked

  // Returns true if the turn is beyond the baked angles by more than rounding.
  bool is_beyond() const { return degrees < low - kSlack || degrees > high + kSlack; }
  static constexpr double kSlack = 0.01;  // degrees
};

// Returns the baked joints as the pose turns them.
//   throws Error for a bone that the rig lacks or that has no parent, and for two baked joints of one bone
std::vector<BentJoint> joints_in_pose(const BakedJoints& baked, const Armature& armature, const Pose& pose);
std::vector<BakedJointReport> report_of_baked(const BakedJoints& baked, const Armature& armature, const Pose& pose);

// Returns one line for each thing about a baked joint in a pose that its stated error does not hold for.
//   glide  how the joints of this pose glide, as a word of core/body/glide_poses.h; "": not told
std::vector<std::string> doubts_of_baked(const std::vector<BakedJointReport>& joints, const std::string& glide);

}  // namespace limber
