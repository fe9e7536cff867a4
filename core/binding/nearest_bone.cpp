// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/flesh_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/binding/geodesic_front.h"

namespace limber {

namespace {
// The last bone of a chain also carries the flesh beyond its tail (four fingers, the toes, the jaw), and most of this
// flesh is further from the bone than the bone is long. So the distance to this bone counts as less: its part beyond
// kOwnReach times the bone's length is multiplied by kLastBone.
constexpr float kOwnReach = 0.5f;
constexpr float kLastBone = 0.65f;
// A bone that only links a limb to the trunk (a collarbone) should get less flesh, since the chest below it belongs to
// the trunk. So the distance to this bone is multiplied by kLink. A bone is a link if its child is so long that the
// bone is shorter than kLinkShare of it, and if it turns aside from a parent with several children.
constexpr float kLink = 1 / kLastBone;
constexpr double kLinkShare = 0.75;
// Lower limit on the ratio of the distance to the nearest bone to the distance to a joint. Flesh above it lies around
// the joint itself, about equally near to the joint's two bones, so the plane through the joint divides it (Hinges).
constexpr float kAtJoint = 0.75f;
// Radius that a bone without bone tissue is assumed to have, as a share of the radius of the flesh around its axis. The
// radius is at least half a voxel's diagonal.
constexpr double kBoneShare = 0.5;
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop
}  // namespace

namespace {

// Returns the distance from a bone's axis to the air, mm. For each of several points along the axis it takes the
// shortest of 26 rays; the result is the median over the points.
double flesh_around(const Bone& bone, const LabelVolume& volume) {
  const AffineTransform from_world = voxel_from_world(volume.grid);
  const double step = std::min({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  const glm::dvec3 size(volume.grid.size);
  // The position is compared before it is converted to int, since a rig may lie further from the volume than an int can
  // represent.
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

std::vector<std::uint16_t> fixed_bone(const LabelVolume& volume, const TissueVoxels& tissue, const BoneParts& parts,
                                      const Armature& armature) {
  std::vector<std::uint16_t> held_by(tissue.size(), kSoft);
  std::vector<bool> has_part(armature.bones.size(), false);
  for (const auto& part : parts.parts) has_part[part.bone] = true;
  parallel_for(tissue.size(), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i)
      if (parts.part_of[i]) held_by[i] = static_cast<std::uint16_t>(parts.parts[parts.part_of[i] - 1].bone);
  });
  if (std::find(has_part.begin(), has_part.end(), false) == has_part.end()) return held_by;

  const AffineTransform from_voxel = world_from_voxel(volume.grid), from_world = voxel_from_world(volume.grid);
  const double voxel = std::max({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z});
  // Distance of each voxel from the axis of the bone that fixes the voxel's temperature, mm; -1: no bone does.
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
glm::dvec3 along(const Bone& bone) { return bone.tail - bone.head; }

bool is_link(const Armature& armature, size_t b) {
  const Bone& bone = armature.bones[b];
  if (bone.parent < 0) return false;
  const double length = glm::length(along(bone));
  const glm::dvec3 before = along(armature.bones[bone.parent]);
  bool forks = false, leads_on = false;
  for (size_t other = 0; other < armature.bones.size(); ++other) {
    forks |= other != b && armature.bones[other].parent == bone.parent;
    leads_on |= armature.bones[other].parent == static_cast<int>(b) &&
                length < kLinkShare * glm::length(along(armature.bones[other]));
  }
  return forks && leads_on && glm::dot(along(bone), before) < 0.5 * length * glm::length(before);
}

// Corrects the distance to a bone before it is compared with other bones' distances: the part of the distance beyond
// `reach` is multiplied by `share`.
struct Count {
  float reach = std::numeric_limits<float>::infinity();  // mm
  float share = 1;
  float operator()(float way) const { return way <= reach ? way : reach + share * (way - reach); }
};

std::vector<Count> counts_of_bones(const Armature& armature) {
  std::vector<bool> last(armature.bones.size(), true);
  for (const Bone& bone : armature.bones)
    if (bone.parent >= 0) last[bone.parent] = false;
  std::vector<Count> counts(armature.bones.size());
  for (size_t b = 0; b < counts.size(); ++b) {
    if (last[b]) counts[b] = {kOwnReach * static_cast<float>(glm::length(along(armature.bones[b]))), kLastBone};
    if (is_link(armature, b)) counts[b] = {0, kLink};
  }
  return counts;
}

// Divides the flesh at joints where exactly two bones meet. Flesh around the joint itself is equally near to the two
// bones. It belongs to the bone on its side of the plane that bisects the angle between the bones: the heel belongs to
// the foot, not to the shin.
class Hinges {
 public:
  explicit Hinges(const Armature& armature) : ends_(armature.bones.size()) {
    std::vector<bool> last(armature.bones.size(), true);
    for (const Bone& bone : armature.bones)
      if (bone.parent >= 0) last[bone.parent] = false;
    for (size_t b = 0; b < ends_.size(); ++b)
      for (int side = 0; side < 2 && !last[b]; ++side) ends_[b][side] = end_of(armature, b, side);
  }

  // Returns the bone that the flesh at `point` belongs to.
  //   nearest, distance  the nearest bone, and its distance, mm
  std::uint16_t bone_at(const glm::vec3& point, std::uint16_t nearest, float distance) const {
    for (const End& end : ends_[nearest]) {
      if (end.other < 0) continue;
      const glm::vec3 from_joint = point - end.joint;
      if (glm::dot(from_joint, end.inward) < 0 && glm::dot(from_joint, end.parting) > 0 &&
          distance >= kAtJoint * glm::length(from_joint))
        return static_cast<std::uint16_t>(end.other);
    }
    return nearest;
  }

 private:
  struct End {
    int other = -1;  // the other bone at this end of the bone; -1: none or several
    glm::vec3 joint, inward, parting;
  };
  static End end_of(const Armature& armature, size_t b, int side) {
    auto joint = [](const Bone& bone, int at) { return at ? bone.tail : bone.head; };
    auto inward = [](const Bone& bone, int at) { return glm::normalize(at ? -along(bone) : along(bone)); };
    const Bone& bone = armature.bones[b];
    const double length = glm::length(along(bone));
    End end;
    int met = 0;
    for (size_t o = 0; o < armature.bones.size(); ++o)
      for (int at = 0; at < 2; ++at) {
        const Bone& other = armature.bones[o];
        const double near = 0.05 * std::min(length, glm::length(along(other)));
        if (o == b || !(near > 0) || glm::distance(joint(bone, side), joint(other, at)) > near) continue;
        ++met;
        end = {static_cast<int>(o), joint(bone, side), inward(bone, side), inward(other, at) - inward(bone, side)};
      }
    return met == 1 ? end : End();
  }
  std::vector<std::array<End, 2>> ends_;
};
}  // namespace

namespace {
NearestBone spread_from_bones(const LabelVolume& volume, const TissueVoxels& tissue,
                              const std::vector<std::uint16_t>& held_by, const std::vector<Count>& counts) {
  NearestBone nearest{held_by, std::vector<float>(tissue.size(), std::numeric_limits<float>::infinity())};
  TissueFront front(volume, tissue);
  // Voxels whose temperature a bone fixes start with distance 0. No path is shorter, so these voxels keep their bone.
  front.start_all([&](std::int64_t place, const glm::ivec3&) {
    if (held_by[place] != kSoft) nearest.distance[place] = 0;
    return held_by[place];
  });
  front.spread(
      nearest.distance,
      [&](std::uint16_t bone, std::int64_t to, float way) { return counts[bone](way) < nearest.distance[to]; },
      [&](std::uint16_t bone, std::int64_t to, float way) {
        nearest.distance[to] = counts[bone](way);
        nearest.bone[to] = bone;
      });
  return nearest;
}
}  // namespace

NearestBone nearest_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                         const std::vector<std::uint16_t>& held_by) {
  return spread_from_bones(volume, tissue, held_by, std::vector<Count>(armature.bones.size()));
}

NearestBone attracting_bone(const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                            const std::vector<std::uint16_t>& held_by) {
  NearestBone nearest = spread_from_bones(volume, tissue, held_by, counts_of_bones(armature));
  const Hinges hinges(armature);
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  parallel_for(std::ssize(tissue.bricks()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    tissue.for_each(begin, end, [&](std::int64_t place, const glm::ivec3& v) {
      if (held_by[place] == kSoft && nearest.bone[place] != kSoft)
        nearest.bone[place] =
            hinges.bone_at(glm::vec3(from_voxel * glm::dvec3(v)), nearest.bone[place], nearest.distance[place]);
    });
  });
  return nearest;
}

}  // namespace limber
