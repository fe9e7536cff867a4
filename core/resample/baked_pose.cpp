// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/baked_pose.h"

#include <cstdio>
#include <set>

#include "core/base/error.h"

namespace limber {

namespace {

constexpr double kOtherTurn = 10;  // degrees; if the joint turns further about other axes, the user is warned

int bone_of(const BakedJoint& joint, const Armature& armature) {
  const auto bone = armature.find(joint.bone);
  if (!bone || armature.bones[*bone].parent < 0)
    throw Error("the rig lacks the bone of a baked joint, or the bone's parent", joint.bone,
                "give the rig that the joint was baked with");
  return *bone;
}

template <class... Numbers>
std::string said(const char* format, Numbers... numbers) {
  char text[256];
  std::snprintf(text, sizeof text, format, numbers...);
  return text;
}

}  // namespace

std::vector<BentJoint> joints_in_pose(const BakedJoints& baked, const Armature& armature, const Pose& pose) {
  std::vector<BentJoint> joints;
  if (baked.empty()) return joints;
  const std::vector<RigidTransform> motions = posed_from_rest(armature, pose);
  std::set<int> bones;
  for (const std::shared_ptr<const BakedJoint>& joint : baked) {
    const int bone = bone_of(*joint, armature);
    if (!bones.insert(bone).second)
      throw Error("two baked joints belong to the same bone", joint->bone, "give only one of the two");
    joints.push_back({.baked = joint,
                      .degrees = turn_about_axis(pose.rotation[bone], joint->axis).degrees,
                      .parent_turn = motions[armature.bones[bone].parent].rotation});
  }
  return joints;
}

std::vector<BakedJointReport> report_of_baked(const BakedJoints& baked, const Armature& armature, const Pose& pose) {
  std::vector<BakedJointReport> reports;
  for (const std::shared_ptr<const BakedJoint>& joint : baked) {
    const TurnAboutAxis turn = turn_about_axis(pose.rotation[bone_of(*joint, armature)], joint->axis);
    reports.push_back({.bone = joint->bone,
                       .degrees = turn.degrees,
                       .low = joint->degrees.front(),
                       .high = joint->degrees.back(),
                       .other_degrees = turn.other_degrees,
                       .baked_at = joint->degrees,
                       .worst_between = worst_between(*joint),
                       .glide = joint->glide});
  }
  return reports;
}

std::vector<std::string> doubts_of_baked(const std::vector<BakedJointReport>& joints, const std::string& glide) {
  std::vector<std::string> doubts;
  for (const BakedJointReport& joint : joints) {
    if (joint.is_beyond())
      doubts.push_back(joint.bone +
                       said(" is turned by %+.4g degrees, but baked from %+.4g to %+.4g only: its flesh is "
                            "shifted as at %+.4g",
                            joint.degrees, joint.low, joint.high, joint.degrees < joint.low ? joint.low : joint.high));
    if (joint.other_degrees > kOtherTurn)
      doubts.push_back(joint.bone + said(" is also turned by %.3g degrees about another axis than the baked one: its "
                                         "flesh has only the shape of blending there",
                                         joint.other_degrees));
    if (!glide.empty() && glide != joint.glide && joint.degrees != 0)
      doubts.push_back("joints are shifted by --glide \"" + glide + "\", but " + joint.bone + " was baked with \"" +
                       joint.glide + "\": the stated error of the baked joint does not hold");
  }
  return doubts;
}

}  // namespace limber
