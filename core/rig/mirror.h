// SPDX-License-Identifier: AGPL-3.0-or-later
// Mirrors a rig's bones and poses. Names pair the bones of both sides: "LeftArm" and "RightArm", "arm.L" and "arm.R"
// (also before a number, "arm.L.001"), "arm_l" and "arm_r", "L_arm" and "R_arm", "LThumb" and "RThumb". The mirror
// plane between left and right is computed from the pairs, so a rig may have any position and direction, and need not
// be exactly symmetric.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

// Returns the name of the bone on the other side; nothing if the name has no side.
std::optional<std::string> mirrored_name(const std::string& name);

// Returns, for each bone, the index of the bone on the other side; the bone's own index if there is none.
std::vector<int> mirror_pairs(const Armature& armature);

struct MirrorPlane {
  glm::dvec3 point{0}, normal{1, 0, 0};  // a point of the plane; its unit normal, from one side to the other

  glm::dvec3 direction(const glm::dvec3& v) const { return v - 2 * glm::dot(v, normal) * normal; }
  glm::dvec3 place(const glm::dvec3& p) const { return point + direction(p - point); }
  glm::dquat rotation(const glm::dquat& q) const;  // returns the mirrored rotation
};

// Returns the bone with head, tail, own axes and limits mirrored; name and parent stay.
Bone mirror_image(const Bone& bone, const MirrorPlane& plane);

// Returns the plane halfway between the bones of the pairs. Without pairs, it is the sagittal plane through the mean of
// the bones without a side, or of all bones.
MirrorPlane mirror_plane(const Armature& armature);

// Returns the mirrored pose, in which every bone moves like the one on the other side.
Pose flipped(const Pose& pose, const Armature& armature);

// Makes the bones on the other side mirror images of `bones`, including limits, and adds missing ones. Bones without a
// side stay as they are.
Armature symmetrized(const Armature& armature, const std::vector<int>& bones);

}  // namespace limber
