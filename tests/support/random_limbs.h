// SPDX-License-Identifier: AGPL-3.0-or-later
// Small random bodies with a rig and a pose. A body is a tree of tubes of skin, fat and bone that branch, touch and lie
// side by side. Each joint is turned by any angle, which flesh may or may not be able to follow.
#pragma once

#include <random>

#include "core/rig/pose.h"
#include "core/tissue/tissue_table.h"
#include "tests/support/bent_tube.h"

namespace limber::test {

struct RandomLimbs {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  Pose pose;
};

class RandomNumbers {
 public:
  explicit RandomNumbers(unsigned seed) : random_(seed) {}
  double any(double low, double high) { return low + (high - low) * double(random_()) / 4294967296.0; }
  int whole(int low, int high) { return low + int(random_() % unsigned(high - low + 1)); }
  bool one_in(int n) { return random_() % unsigned(n) == 0; }
  glm::dvec3 direction() {
    for (;;)
      if (const glm::dvec3 d(any(-1, 1), any(-1, 1), any(-1, 1)); glm::length(d) > 0.1 && glm::length(d) < 1)
        return glm::normalize(d);
  }

 private:
  std::mt19937 random_;
};

// Turns each joint about a random axis, except that on average one joint in three stays at rest.
inline void turn_joints(Pose& pose, RandomNumbers& random, double most_degrees) {
  for (size_t b = 1; b < pose.rotation.size(); ++b)
    if (!random.one_in(3))
      pose.rotation[b] = glm::angleAxis(random.any(0, most_degrees) * std::numbers::pi / 180, random.direction());
  if (random.one_in(4)) pose.rotation[0] = glm::angleAxis(random.any(0, 3), random.direction());
}

inline RandomLimbs random_limbs(unsigned seed) {
  RandomNumbers random(seed);
  RandomLimbs limbs;
  limbs.tissues = tube_tissues();
  const int count = random.whole(2, 5);
  std::vector<double> radius;
  for (int b = 0; b < count; ++b) {
    Bone bone;
    bone.name = "bone " + std::to_string(b);
    bone.parent = b == 0 ? -1 : random.whole(std::max(0, b - 2), b - 1);
    const glm::dvec3 way = b == 0
                               ? glm::dvec3(0, 0, 1)
                               : glm::normalize(limbs.rig.bones[bone.parent].tail - limbs.rig.bones[bone.parent].head);
    bone.head = b == 0 ? glm::dvec3(0) : limbs.rig.bones[bone.parent].tail;
    bone.tail = bone.head + random.any(15, 40) * glm::normalize(way + 0.9 * random.direction());
    limbs.rig.bones.push_back(bone);
    radius.push_back(random.any(5, 11));
  }

  const double gap = random.any(-1, 3), core = random.any(0.25, 0.6), voxel = random.any(1.5, 2.5);
  Grid& grid = limbs.volume.grid;
  grid.spacing = random.one_in(3) ? glm::dvec3(voxel, voxel, 1.5 * voxel) : glm::dvec3(voxel);
  glm::dvec3 low(0), high(0);
  for (const Bone& bone : limbs.rig.bones)
    low = glm::min(low, glm::min(bone.head, bone.tail)), high = glm::max(high, glm::max(bone.head, bone.tail));
  grid.origin = low - 14.0;
  grid.size = glm::ivec3((high - low + 28.0) / grid.spacing) + 1;
  limbs.volume.voxels.assign(grid.voxel_count(), 0);
  const AffineTransform world = world_from_voxel(grid);
  glm::ivec3 v;
  for (v.z = 0; v.z < grid.size.z; ++v.z)
    for (v.y = 0; v.y < grid.size.y; ++v.y)
      for (v.x = 0; v.x < grid.size.x; ++v.x) {
        double outside = 1e9;
        bool bone = false;
        for (int b = 0; b < count; ++b) {
          const Bone& tube = limbs.rig.bones[b];
          const glm::dvec3 p = world * glm::dvec3(v);
          outside = std::min(outside, distance_to_bone(tube, p) - radius[b]);
          Bone shaft = tube;
          const glm::dvec3 along = glm::normalize(tube.tail - tube.head);
          const double short_by = core * radius[b] + 0.5 * gap;
          shaft.head += short_by * along, shaft.tail -= short_by * along;
          bone |= glm::dot(shaft.tail - shaft.head, along) > 0 && distance_to_bone(shaft, p) < core * radius[b];
        }
        if (outside <= 0) limbs.volume.at(v) = bone ? kBone : outside > -1.2 * voxel ? kSkin : kFat;
      }

  limbs.pose = rest_pose(limbs.rig);
  turn_joints(limbs.pose, random, random.one_in(2) ? 60 : 180);
  return limbs;
}

}  // namespace limber::test
