// SPDX-License-Identifier: AGPL-3.0-or-later
// The two sides of a rig. Bones belong together by their names: "LeftArm" and "RightArm", "arm.L" and "arm.R" (also
// before a number, "arm.L.001"), "arm_l" and "arm_r", "L_arm" and "R_arm", "LThumb" and "RThumb". The plane between the
// sides is taken from the pairs themselves, so a rig may stand anywhere, face anywhere, and need not be quite
// symmetric.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

// The name of the bone on the other side; nothing for a name that has no side.
std::optional<std::string> mirrored_name(const std::string& name);

// #bones: the bone on the other side, the bone itself where it has none.
std::vector<int> mirror_pairs(const Armature& armature);

struct MirrorPlane {
  glm::dvec3 point{0}, normal{1, 0, 0};  // unit, from one side to the other

  glm::dvec3 direction(const glm::dvec3& v) const { return v - 2 * glm::dot(v, normal) * normal; }
  glm::dvec3 place(const glm::dvec3& p) const { return point + direction(p - point); }
  glm::dquat rotation(const glm::dquat& q) const;  // what it looks like in the mirror
};

// Head, tail, own axes and limits in the mirror; name and parent as they are.
Bone mirror_image(const Bone& bone, const MirrorPlane& plane);

// Halfway between the pairs; where there are none, the sagittal plane through the bones that have no side, else through
// all.
MirrorPlane mirror_plane(const Armature& armature);

// Every bone moves as the one on the other side did.
Pose flipped(const Pose& pose, const Armature& armature);

// The other sides of `bones` become their mirror images, limits included; what is missing there is added. Bones without
// a side are left alone.
Armature symmetrized(const Armature& armature, const std::vector<int>& bones);

}  // namespace limber
