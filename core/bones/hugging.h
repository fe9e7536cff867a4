// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures the distance of voxels from each rig bone. Connected rig bones share an end point, so the ends of the bones
// are left out. Near a joint, the directions of the bones then decide which bone is nearer.
#pragma once

#include <vector>

#include "core/rig/armature.h"
#include "core/volume/label_volume.h"

namespace limber {

class Hugging {
 public:
  Hugging(const Armature& armature, const Grid& grid);
  int bone_count() const { return static_cast<int>(segments_.size()); }
  // Returns the distance from a voxel to a rig bone, mm. A tenth of the rig bone's length is left out at both ends.
  double distance(int bone, const glm::ivec3& voxel) const {
    return distance_to_bone(segments_[bone], world_from_voxel_ * glm::dvec3(voxel));
  }
  // Returns the distance from a voxel to a rig bone, mm. At each joint, all bones that meet there are shortened by the
  // same length, so that the border between two bones is the plane that bisects the angle between them.
  double parting_distance(int bone, const glm::ivec3& voxel) const {
    return distance_to_bone(parting_[bone], world_from_voxel_ * glm::dvec3(voxel));
  }
  glm::dvec3 world(const glm::dvec3& voxel) const { return world_from_voxel_ * voxel; }

 private:
  AffineTransform world_from_voxel_;
  std::vector<Bone> segments_, parting_;
};

}  // namespace limber
