// SPDX-License-Identifier: AGPL-3.0-or-later
// Named poses for any body ("sit", "walk"), given by the angles of its joints from the anatomical position.
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
  std::string_view name;         // "sit"
  std::string_view description;  // a full sentence
  // Joint requests (joint_angles.h), separated by semicolons. Limb joints that are not named take the anatomical
  // position; spine, neck, fingers and toes keep their rest pose, and collarbones follow raised arms.
  std::string_view joints;
};

std::span<const BodyPose> body_poses();

// Finds a body pose by its name, in upper or lower case; "_", "-" and blanks are equal. Throws Error that lists the
// known names.
const BodyPose& require_body_pose(const std::string& name, const std::string& where);

JointAngles angles_of(const BodyPose& pose);

// A requested pose: the name of a body pose, single joints that override it, or both.
struct PoseRequest {
  std::string name;                 // one of body_poses(); empty: none
  std::vector<std::string> joints;  // joint requests (joint_angles.h)

  bool empty() const { return name.empty() && joints.empty(); }
};

// Returns `pose` with the requested joint angles. Joints of a named pose that the rig does not have are left out. Adds
// to `warnings` a line for each requested angle that adults do not reach, and lines for bones beyond the rig's own
// limits and for other doubts about the rig. Throws Error for an unknown name or joint, or a requested joint that the
// rig does not have.
Pose with_request(const Armature& armature, const Pose& pose, const PoseRequest& request,
                  std::vector<std::string>& warnings);

// Returns the named poses that this rig can take, as entries of a pose library without pictures. Each entry contains
// the bones of all joints that the pose sets. Returns an empty library if no limb joint is recognised.
PoseLibrary body_pose_library(const Armature& armature);

}  // namespace limber
