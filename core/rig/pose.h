// SPDX-License-Identifier: AGPL-3.0-or-later
// A pose turns every bone about its head, relative to rest and to its parent. Rotations are in world axes at rest:
//   posed_from_rest(bone) = posed_from_rest(parent) * rotation_about(head, rotation)
// which is the skinning matrix of the bone (pose * inverse(rest) in Blender's terms). A joint that glides also shifts
// its bone:
//   posed_from_rest(bone) = posed_from_rest(parent) * translation(shift) * rotation_about(head, rotation)
#pragma once

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/rig/armature.h"

namespace limber {

struct Pose {
  std::vector<glm::dquat> rotation;  // #bones, unit
  glm::dvec3 root_translation{0};    // mm, applied to every root bone
  // #bones or empty where no joint glides, mm, in world axes at rest as the parent stands. Only glide_joints() makes it
  // (core/resample/glide_joints.h): files, documents and clips hold poses without it.
  std::vector<glm::dvec3> shift{};

  bool operator==(const Pose&) const = default;
};

Pose rest_pose(const Armature& armature);

// #bones skinning transforms, exactly the identity for a bone that nothing moves.
std::vector<RigidTransform> posed_from_rest(const Armature& armature, const Pose& pose);

// `pose` with `bone` turned by `degrees` about its flex_axis, after what it already has.
void flex(Pose& pose, const Armature& armature, int bone, double degrees);

}  // namespace limber
