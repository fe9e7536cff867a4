// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/flesh_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/binding/chest_reach.h"
#include "core/binding/geodesic_front.h"

namespace limber {

namespace {
// Assumed radius of a bone without bone tissue, as a share of the radius of the flesh around its axis. The radius is at
// least half a voxel's diagonal.
constexpr double kBoneShare = 0.5;
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop
}  // namespace

namespace {

// Returns the distance from a bone's axis to the air, mm. At each of several points along the axis, the shortest of 26
// rays is used; the result is the median over the points.
double flesh_around(const Bone& bone, const LabelVolume& volume) {
  const AffineTransform from_world = voxel_from_world(volume.grid);
  const double step = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  const glm::dvec3 size(volume.grid.size);
  // Compares the position before converting it to int, since the position of a rig far away from the volume may exceed
  // the range of int.
  auto is_air = [&](const glm::dvec3& at) {
    const bool inside = glm::all(glm::greaterThanEqual(at, glm::dvec3(0))) && glm::all(glm::lessThan(at, size));
    return !inside || volume.at(glm::ivec3(at)) == 0;
  };
  constexpr int kPoints = 9;
  std::vector<double> depths;
  for (int k = 0; k < kPoints; ++k) {
    const glm::dvec3 at = glm::mix(bone.head, bone.tail, (k + 0.5) / kPoints);
    double shortest = std::numeric_limits<double>::max();
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          if (x == 0 && y == 0 && z == 0) continue;
          const glm::dvec3 along = glm::normalize(glm::dvec3(x, y, z)) * step;
          for (int n = 0; n * step < shortest; ++n)
            if (is_air(from_world * (at + double(n) * along) + 0.5)) shortest = n * step;
        }
    depths.push_back(shortest);
  }
  std::nth_element(depths.begin(), depths.begin() + kPoints / 2, depths.end());
  return depths[kPoints / 2];
}
}  // namespace

ZeroedVector<std::uint16_t> fixed_bone(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                                       const Armature& armature) {
  ZeroedVector<std::uint16_t> held_by(tissue.size());
  std::vector<bool> has_part(armature.bones.size(), false);
  for (const auto& part : parts.parts) has_part[part.bone] = true;
  parallel_for(tissue.size(), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      held_by[i] = parts.part_of[i] ? static_cast<std::uint16_t>(parts.parts[parts.part_of[i] - 1].bone) : kSoft;
  });
  if (std::find(has_part.begin(), has_part.end(), false) == has_part.end()) return held_by;

  const AffineTransform from_voxel = world_from_voxel(volume.grid), from_world = voxel_from_world(volume.grid);
  const double voxel = std::max({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  // Distance of each voxel from the axis of the bone that holds the voxel, mm; -1: no bone does.
  std::vector<float> nearest(tissue.size(), -1);
  for (size_t b = 0; b < armature.bones.size(); ++b) {
    if (has_part[b]) continue;
    const Bone& bone = armature.bones[b];
    const double radius = std::max(0.87 * voxel, kBoneShare * flesh_around(bone, volume));
    glm::dvec3 lowest(1e300), highest(-1e300);
    for (const glm::dvec3& end : {bone.head, bone.tail})
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at =
            from_world * (end + radius * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
        lowest = glm::min(lowest, at);
        highest = glm::max(highest, at);
      }
    const glm::ivec3 begin(glm::clamp(glm::floor(lowest), glm::dvec3(0), glm::dvec3(volume.grid.size)));
    const glm::ivec3 end(glm::clamp(glm::ceil(highest) + 1.0, glm::dvec3(0), glm::dvec3(volume.grid.size)));
    for (int z = begin.z; z < end.z; ++z)
      for (int y = begin.y; y < end.y; ++y)
        for (int x = begin.x; x < end.x; ++x) {
          const std::int64_t place = tissue.index_of({x, y, z});
          if (place < 0 || parts.part_of[place]) continue;
          const auto d = static_cast<float>(distance_to_bone(bone, from_voxel * glm::dvec3(x, y, z)));
          if (d > radius || (nearest[place] >= 0 && nearest[place] <= d)) continue;
          nearest[place] = d;
          held_by[place] = static_cast<std::uint16_t>(b);
        }
  }
  return held_by;
}

namespace {
NearestBone spread_from_bones(const LabelVolume& volume, const TissueVoxels& tissue,
                              const ZeroedVector<std::uint16_t>& held_by, const std::vector<BoneReach>& reaches) {
  NearestBone nearest;
  nearest.bone.assign(held_by.begin(), held_by.end());
  nearest.distance.assign(tissue.size(), std::numeric_limits<float>::infinity());
  TissueFront front(volume, tissue);
  // Voxels held by a bone start with distance 0. No path is shorter, so these voxels keep their bone.
  front.start_all([&](std::int64_t place, const glm::ivec3&) {
    if (held_by[place] != kSoft) nearest.distance[place] = 0;
    return held_by[place];
  });
  front.spread(
      {nearest.distance.data(), nearest.distance.size()},
      [&](std::uint16_t bone, std::int64_t to, float way) { return reaches[bone](way) < nearest.distance[to]; },
      [&](std::uint16_t bone, std::int64_t to, float way) {
        nearest.distance[to] = reaches[bone](way);
        nearest.bone[to] = bone;
      });
  return nearest;
}
}  // namespace

NearestBone nearest_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                         const ZeroedVector<std::uint16_t>& held_by) {
  return spread_from_bones(volume, tissue, held_by, std::vector<BoneReach>(armature.bones.size()));
}

NearestBone attracting_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                            const ZeroedVector<std::uint16_t>& held_by) {
  const std::vector<BoneReach> reaches = reaches_in_body(volume.grid, tissue, armature, held_by);
  NearestBone nearest = spread_from_bones(volume, tissue, held_by, reaches);
  const Hinges hinges(armature);
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  parallel_for(std::ssize(tissue.bricks()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    tissue.for_each(begin, end, [&](std::int64_t place, const glm::ivec3& v) {
      if (held_by[place] != kSoft || nearest.bone[place] == kSoft) return;
      nearest.distance[place] = reaches[nearest.bone[place]].held_from(nearest.distance[place]);
      nearest.bone[place] =
          hinges.bone_at(glm::vec3(from_voxel * glm::dvec3(v)), nearest.bone[place], nearest.distance[place]);
    });
  });
  return nearest;
}

}  // namespace limber
