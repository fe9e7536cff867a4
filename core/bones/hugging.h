// SPDX-License-Identifier: AGPL-3.0-or-later
// How far voxels lie from each rig bone. Bones that share the point in which they meet are told apart by direction.
#pragma once

#include <vector>

#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

class Hugging {
 public:
  Hugging(const Armature& armature, const Grid& grid);
  int bone_count() const { return static_cast<int>(segments_.size()); }
  // Two bones share the point where they meet; a tenth cut off at either end decides by direction there.
  double distance(int bone, const glm::ivec3& voxel) const {
    return distance_to_bone(segments_[bone], world_from_voxel_ * glm::dvec3(voxel));
  }
  // Cut back by the same length where they meet, so that bones part at the plane that halves the angle between them.
  double parting_distance(int bone, const glm::ivec3& voxel) const {
    return distance_to_bone(parting_[bone], world_from_voxel_ * glm::dvec3(voxel));
  }
  glm::dvec3 world(const glm::dvec3& voxel) const { return world_from_voxel_ * voxel; }

 private:
  AffineTransform world_from_voxel_;
  std::vector<Bone> segments_, parting_;
};

}  // namespace limber
