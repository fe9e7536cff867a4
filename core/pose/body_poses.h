// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses that any body can take, by the angles of its joints from the anatomical position.
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
  std::string_view description;  // a sentence
  // Requests of joint_angles.h with a semicolon between. Limbs stand in the anatomical position where nothing is said;
  // spine, neck, fingers and toes keep their rest, collarbones go with raised arms.
  std::string_view joints;
};

std::span<const BodyPose> body_poses();

// By its name in any case, "_" as good as "-". throws Error that lists the names
const BodyPose& require_body_pose(const std::string& name, const std::string& where);

JointAngles angles_of(const BodyPose& pose);

// What is asked of a body: a pose by its name, single joints over it, either or both.
struct PoseRequest {
  std::string name;                 // of body_poses(); empty: none
  std::vector<std::string> joints;  // requests of joint_angles.h

  bool empty() const { return name.empty() && joints.empty(); }
};

// `pose` with the joints that are asked for; of a named pose what the rig lacks is left out. `warnings` gets a line for
// each asked angle that adults do not reach, and one that lists bones beyond the rig's own limits. throws Error for a
// name or a joint that is not known or that the rig lacks
Pose with_request(const Armature& armature, const Pose& pose, const PoseRequest& request,
                  std::vector<std::string>& warnings);

// The named poses that this rig can take, as entries of a library (pose_library.h): with all bones of the joints that
// they set, and without pictures. None where no limb's joint is known.
PoseLibrary body_pose_library(const Armature& armature);

}  // namespace limber
