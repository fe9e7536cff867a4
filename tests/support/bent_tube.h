// SPDX-License-Identifier: AGPL-3.0-or-later
// A limb that is small enough to check by hand: a round tube along z of skin, fat and two bones with a gap at the
// joint. Its rig has two bones that meet at the joint. In soft tissue the skin weights change over a few voxels around
// the joint; in bone each voxel has the weight 1 of one rig bone.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rig/pose.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"

namespace limber::test {

constexpr Label kSkin = 1, kFat = 2, kBone = 3;

struct BentTube {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  SkinWeights weights;

  // Returns the pose in which bone 1 is turned about x (across the tube) by `degrees`, and about its own length by
  // `twist_degrees`.
  Pose pose(double degrees, double twist_degrees = 0) const {
    Pose pose = rest_pose(rig);
    const double radians = std::numbers::pi / 180;
    const glm::dvec3 length = glm::normalize(rig.bones[1].tail - rig.bones[1].head);
    pose.rotation[1] = glm::angleAxis(degrees * radians, glm::normalize(volume.grid.direction[0])) *
                       glm::angleAxis(twist_degrees * radians, length);
    return pose;
  }
};

// Returns a grid with three different spacings, whose axes are rotated and mirrored.
inline Grid oblique_grid() {
  Grid grid;
  grid.spacing = {0.7, 2.1, 1.3};
  grid.origin = {-31.7, 12.9, 1003.3};
  grid.direction = glm::mat3_cast(glm::angleAxis(0.61, glm::normalize(glm::dvec3(1, -2, 0.5))));
  grid.direction[1] = -grid.direction[1];  // mirrors the grid's second axis
  return grid;
}

inline TissueTable tube_tissues() {
  TissueTable table;
  for (auto [label, name, kind] : {std::tuple{kSkin, "skin", TissueKind::Skin},
                                   {kFat, "fat", TissueKind::Fat},
                                   {kBone, "bone", TissueKind::Bone}}) {
    Tissue tissue;
    tissue.label = label;
    tissue.name = name;
    tissue.kind = kind;
    apply_kind_defaults(tissue);
    table.tissues.push_back(tissue);
  }
  return table;
}

// Returns the tube.
//   grid    gives the spacing, origin and direction of the tube's volume
//   length  number of voxels along z
inline BentTube bent_tube(const Grid& grid = {}, int length = 44) {
  constexpr double kRadius = 8, kBoneRadius = 2.3, kBlend = 6;
  BentTube tube;
  tube.volume.grid = grid;
  tube.volume.grid.size = {23, 25, length};
  tube.volume.voxels.assign(tube.volume.grid.voxel_count(), 0);
  const int joint = length / 2;
  for (int z = 2; z < length - 3; ++z)
    for (int y = 0; y < 25; ++y)
      for (int x = 0; x < 23; ++x) {
        const double r = std::hypot(x - 11, y - 12);
        if (r > kRadius) continue;
        const bool bone = r <= kBoneRadius && std::abs(z - joint) > 4 && z > 4 && z < length - 6;
        tube.volume.at({x, y, z}) = bone ? kBone : r > kRadius - 1.2 ? kSkin : kFat;
      }
  tube.tissues = tube_tissues();

  const AffineTransform world = world_from_voxel(tube.volume.grid);
  const glm::dvec3 ends[] = {world * glm::dvec3(11, 12, 2), world * glm::dvec3(11, 12, joint),
                             world * glm::dvec3(11, 12, length - 4)};
  for (int b = 0; b < 2; ++b) {
    Bone bone;
    bone.name = b ? "far" : "near";
    bone.parent = b - 1;
    bone.head = ends[b];
    bone.tail = ends[b + 1];
    tube.rig.bones.push_back(bone);
  }

  const TissueVoxels tissue(tube.volume);
  tube.weights = SkinWeights({"near", "far"}, tissue);
  for (std::int64_t b = 0; b < std::ssize(tissue.bricks()); ++b) {
    SkinWeights::Influences chunk;
    tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
      const double t = std::clamp((v.z - joint) / (2 * kBlend) + 0.5, 0.0, 1.0), far = t * t * (3 - 2 * t);
      chunk.push_back(tube.volume.at(v) == kBone ? rigid_influence(v.z > joint) : quantize({{0, 1 - far}, {1, far}}));
    });
    tube.weights.set_chunk(b, std::move(chunk));
  }
  return tube;
}

}  // namespace limber::test
