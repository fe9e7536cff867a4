// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/hugging.h"

#include <algorithm>

namespace limber {

namespace {
Bone cut_back(const Bone& bone, double at_head, double at_tail) {
  const double length = glm::length(bone.tail - bone.head);
  const glm::dvec3 along = length > 0 ? (bone.tail - bone.head) / length : glm::dvec3(0);
  Bone segment;
  segment.head = bone.head + at_head * along;
  segment.tail = bone.tail - at_tail * along;
  return segment;
}
}  // namespace

Hugging::Hugging(const Armature& armature, const Grid& grid) : world_from_voxel_(world_from_voxel(grid)) {
  for (const Bone& bone : armature.bones) {
    const double length = glm::length(bone.tail - bone.head);
    double at_head = length, at_tail = length;
    for (const Bone& other : armature.bones) {
      const double other_length = glm::length(other.tail - other.head), near = 0.05 * std::min(length, other_length);
      for (const glm::dvec3& end : {other.head, other.tail}) {
        if (glm::distance(bone.head, end) <= near) at_head = std::min(at_head, other_length);
        if (glm::distance(bone.tail, end) <= near) at_tail = std::min(at_tail, other_length);
      }
    }
    segments_.push_back(cut_back(bone, 0.1 * length, 0.1 * length));
    parting_.push_back(cut_back(bone, 0.1 * at_head, 0.1 * at_tail));
  }
}

}  // namespace limber
