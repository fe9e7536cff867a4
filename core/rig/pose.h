// SPDX-License-Identifier: AGPL-3.0-or-later
// A pose rotates every bone about its head, relative to the rest pose and to the parent bone. A rotation is given in
// the world axes of the rest pose:
//   posed_from_rest(bone) = posed_from_rest(parent) * rotation_about(head, rotation)
// This is the skinning matrix of the bone (pose * inverse(rest) in Blender's terms). A gliding joint also translates
// its bone:
//   posed_from_rest(bone) = posed_from_rest(parent) * translation(shift) * rotation_about(head, rotation)
#pragma once

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/rig/armature.h"

namespace limber {

struct Pose {
  std::vector<glm::dquat> rotation;  // one unit quaternion per bone
  glm::dvec3 root_translation{0};    // shift of every root bone, mm
  // One translation per bone, mm, for joints that glide. Its axes are the world's axes at rest, rotated with the parent
  // bone. Empty: no joint glides. Only glide_joints() (core/resample/glide_joints.h) sets translations; poses in files,
  // documents and clips have none.
  std::vector<glm::dvec3> shift{};

  bool operator==(const Pose&) const = default;
};

Pose rest_pose(const Armature& armature);

// Returns the skinning transform of each bone, from the rest pose to the given pose. For a bone that does not move,
// this is exactly the identity.
std::vector<RigidTransform> posed_from_rest(const Armature& armature, const Pose& pose);

// Rotates `bone` by `degrees` about its flex_axis(), after the rotation that it already has.
void flex(Pose& pose, const Armature& armature, int bone, double degrees);

}  // namespace limber
