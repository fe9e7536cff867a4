// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds how a pose of the rig turns its baked joints (deform/baked_joint.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/deform/baked_flesh.h"
#include "core/rig/pose.h"

namespace limber {

using BakedJoints = std::vector<std::shared_ptr<const BakedJoint>>;

// The rotation of a baked joint in a pose, and facts about the joint for the report.
struct BakedJointReport {
  std::string bone;
  double degrees = 0;            // turn about the baked axis
  double low = 0, high = 0;      // range of the baked angles, degrees; beyond an end the shifts of that end are used
  double other_degrees = 0;      // rotation about other axes, for which no shifts were baked, degrees
  std::vector<double> baked_at;  // the baked angles, degrees
  BakeError worst_between;       // the largest error that was found between baked angles
  std::string glide;  // setting by which joints glided when the joint was baked: a word of core/body/glide_poses.h

  // Returns true if the angle is outside the range of the baked angles by more than kSlack.
  bool is_beyond() const { return degrees < low - kSlack || degrees > high + kSlack; }
  static constexpr double kSlack = 0.01;  // how far an angle may exceed the range without being beyond it, degrees
};

// Returns the baked joints with their rotations in the pose.
//   throws  Error for a bone that the rig lacks or that has no parent, and if two baked joints have one bone
std::vector<BentJoint> joints_in_pose(const BakedJoints& baked, const Armature& armature, const Pose& pose);
std::vector<BakedJointReport> report_of_baked(const BakedJoints& baked, const Armature& armature, const Pose& pose);

// Returns one line for each reason why the stated error of a baked joint does not hold in a pose.
//   glide  setting by which the joints of this pose glide, a word of core/body/glide_poses.h; "": unknown
std::vector<std::string> doubts_of_baked(const std::vector<BakedJointReport>& joints, const std::string& glide);

}  // namespace limber
