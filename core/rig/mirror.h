// SPDX-License-Identifier: AGPL-3.0-or-later
// Mirrors a rig's bones and poses. A left bone and a right bone are a pair if their names differ only in the side:
// "LeftArm" and "RightArm", "arm.L" and "arm.R" (also before a number, "arm.L.001"), "arm_l" and "arm_r", "L_arm" and
// "R_arm", "LThumb" and "RThumb". The mirror plane is computed from the pairs, so a rig may have any position and
// direction, and need not be exactly symmetric.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

// Returns the name of the bone on the other side of the body. Returns nothing for a name that tells no side.
std::optional<std::string> mirrored_name(const std::string& name);

// Returns, for each bone, the index of its counterpart on the other side of the body, or its own index if there is
// none.
std::vector<int> mirror_pairs(const Armature& armature);

struct MirrorPlane {
  glm::dvec3 point{0}, normal{1, 0, 0};  // a point of the plane, mm; the plane's unit normal

  glm::dvec3 direction(const glm::dvec3& v) const { return v - 2 * glm::dot(v, normal) * normal; }
  glm::dvec3 place(const glm::dvec3& p) const { return point + direction(p - point); }
  glm::dquat rotation(const glm::dquat& q) const;  // returns the mirrored rotation
};

// Returns a copy of the bone with mirrored head, tail, own axes and limits. Name and parent stay.
Bone mirror_image(const Bone& bone, const MirrorPlane& plane);

// Returns the plane halfway between the left and right bones of the pairs. For a rig without pairs, returns the
// sagittal plane through the mean position of the bones whose names tell no side, or else of all bones.
MirrorPlane mirror_plane(const Armature& armature);

// Returns the mirrored pose: every bone gets the mirrored rotation of its counterpart on the other side.
Pose flipped(const Pose& pose, const Armature& armature);

// Makes the counterparts of `bones` on the other side mirror images of them, including limits, and adds missing
// counterparts. Bones whose names tell no side stay unchanged.
Armature symmetrized(const Armature& armature, const std::vector<int>& bones);

}  // namespace limber
