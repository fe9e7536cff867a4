// SPDX-License-Identifier: AGPL-3.0-or-later
// Named poses for any body ("sit", "walk"), given as joint angles that are measured from the anatomical position.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/pose/joint_angles.h"
#include "core/pose/pose_library.h"
#include "core/rig/pose.h"

namespace limber {

struct BodyPose {
  std::string_view name;         // name of the pose, for example "sit"
  std::string_view description;  // a full sentence for the user
  // Joint requests such as "hips flexion=90" (joint_angles.h), separated by semicolons. In a pose of the whole body,
  // shoulders, elbows, forearms, wrists, hips, knees and ankles without a request take the anatomical position. Spine,
  // neck, fingers and toes without a request do not move. Collarbones follow raised arms.
  std::string_view joints;
  bool whole = true;  // false: a pose of the hands, which leaves the limbs as they are
};

std::span<const BodyPose> body_poses();

// Finds a named pose of the body. Upper and lower case are equal; "_", "-" and blanks are ignored. Throws Error for an
// unknown name, and lists the known ones.
//   where  names the source of the pose's name in the error message
const BodyPose& require_body_pose(const std::string& name, const std::string& where);

JointAngles angles_of(const BodyPose& pose);

// A requested pose: the name of a body pose, single joints that override it, or both.
struct PoseRequest {
  std::string name;                 // name of one of body_poses(); empty: no named pose
  std::vector<std::string> joints;  // joint requests such as "left elbow flexion=30" (joint_angles.h)

  bool empty() const { return name.empty() && joints.empty(); }
};

// Returns `pose` with the requested joint angles. Joints of a named pose that the rig does not have are left out. Adds
// lines to `warnings`: one for each requested angle that adults do not reach, one for bones beyond the rig's own
// limits, and others if the rig's bones look wrong (feet that point backwards, bones apart from their limb). Throws
// Error for an unknown pose or joint, or for a single requested joint that the rig does not have.
Pose with_request(const Armature& armature, const Pose& pose, const PoseRequest& request,
                  std::vector<std::string>& warnings);

// Returns the named poses that this rig can take, as entries of a pose library without pictures. Each entry contains
// the bones of all joints that the pose sets. Returns an empty library if no limb joint is recognised.
PoseLibrary body_pose_library(const Armature& armature);

}  // namespace limber
