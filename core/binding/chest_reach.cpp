// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/chest_reach.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/parallel.h"
#include "core/binding/flesh_graph.h"
#include "core/rig/bone_roles.h"

namespace limber {

namespace {
// Half the width of a rib cage, as a share of the distance between the trunk's axis and a shoulder joint.
constexpr double kCageWidth = 0.75;
// A bone has ribs if the root mean square distance of its tissue from its axis is at least this share of half the
// cage's width. For vertebrae alone the value is about 0.2, with ribs 0.6 and more.
constexpr double kHasRibs = 0.4;
// The rib cage ends at this share of the way down from the shoulders to the hips.
constexpr double kCageEnd = 0.6;
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop

bool is_of_arm(const std::optional<JointRole>& role) {
  if (!role) return false;
  switch (role->part) {
    case BodyPart::Clavicle:
    case BodyPart::UpperArm:
    case BodyPart::Forearm:
    case BodyPart::Hand:
    case BodyPart::Palm:
    case BodyPart::Fingers:
    case BodyPart::Thumb:
    case BodyPart::Index:
    case BodyPart::Middle:
    case BodyPart::Ring:
    case BodyPart::Little: return true;
    default: return false;
  }
}

// Returns the mean head of the bones of a body part; nothing if there are none.
std::optional<glm::dvec3> middle_of(const Armature& armature, const BoneRoles& roles, BodyPart part) {
  glm::dvec3 sum(0);
  int count = 0;
  for (std::size_t b = 0; b < roles.size(); ++b)
    if (roles[b] && roles[b]->part == part) {
      sum += armature.bones[b].head;
      ++count;
    }
  if (count == 0) return std::nullopt;
  return sum / double(count);
}

// The bones of the spine at the height of the ribs, the bones of the arms, and half the width in mm that a rib cage
// would have.
struct Chest {
  std::vector<std::uint16_t> bones, arms;
  double half_width = 0;
};

Chest chest_of(const Armature& armature) {
  // Bones with unknown names, such as twist bones of an arm, do not show where joints are.
  const BoneRoles roles = bone_roles(armature), inherited = inherited_bone_roles(armature);
  const auto shoulders = middle_of(armature, roles, BodyPart::UpperArm);
  const auto thighs = middle_of(armature, roles, BodyPart::Thigh);
  const auto hips = thighs ? thighs : middle_of(armature, roles, BodyPart::Pelvis);
  Chest chest;
  if (!shoulders || !hips || *hips == *shoulders) return chest;
  const glm::dvec3 down = *hips - *shoulders;
  // The trunk's axis leads from the hips to the neck, so that a single arm's shoulder is beside this axis too. Without
  // a neck, the mean of the shoulders is used.
  const auto neck = middle_of(armature, roles, BodyPart::Neck);
  const glm::dvec3 up = glm::normalize((neck ? *neck : *shoulders) - *hips);
  for (std::size_t b = 0; b < roles.size(); ++b) {
    if (is_of_arm(inherited[b])) chest.arms.push_back(static_cast<std::uint16_t>(b));
    if (!roles[b]) continue;
    const Bone& bone = armature.bones[b];
    if (roles[b]->part == BodyPart::Spine &&
        glm::dot(0.5 * (bone.head + bone.tail) - *shoulders, down) < kCageEnd * glm::dot(down, down))
      chest.bones.push_back(static_cast<std::uint16_t>(b));
    if (roles[b]->part == BodyPart::UpperArm) {
      const glm::dvec3 from_hips = bone.head - *hips;
      const double across = glm::length(from_hips - glm::dot(from_hips, up) * up);
      chest.half_width = std::max(chest.half_width, kCageWidth * across);
    }
  }
  return chest;
}

// Returns the root mean square distance of each chest bone's tissue from the bone's axis, mm.
std::vector<double> distances_of_tissue(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                                        const ZeroedVector<std::uint16_t>& held_by, const Chest& chest) {
  struct Sum {
    double squares = 0, count = 0;
  };
  std::vector<int> number(armature.bones.size(), -1);
  for (std::size_t k = 0; k < chest.bones.size(); ++k) number[chest.bones[k]] = static_cast<int>(k);
  const AffineTransform from_voxel = world_from_voxel(grid);
  const auto bricks = std::ssize(tissue.bricks());
  std::vector<std::vector<Sum>> parts((bricks + kGrain - 1) / kGrain, std::vector<Sum>(chest.bones.size()));
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<Sum>& part = parts[begin / kGrain];
    tissue.for_each(begin, end, [&](std::int64_t place, const glm::ivec3& v) {
      if (held_by[place] == kSoft || number[held_by[place]] < 0) return;
      const double distance = distance_to_bone(armature.bones[held_by[place]], from_voxel * glm::dvec3(v));
      Sum& sum = part[number[held_by[place]]];
      sum.squares += distance * distance;
      sum.count += 1;
    });
  });
  std::vector<double> distances;
  for (std::size_t k = 0; k < chest.bones.size(); ++k) {
    Sum all;
    for (const std::vector<Sum>& part : parts) all.squares += part[k].squares, all.count += part[k].count;
    distances.push_back(all.count > 0 ? std::sqrt(all.squares / all.count) : 0);
  }
  return distances;
}
}  // namespace

bool widen_chest(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                 const ZeroedVector<std::uint16_t>& held_by, std::vector<BoneReach>& reaches) {
  const Chest chest = chest_of(armature);
  if (chest.bones.empty()) return false;
  bool is_bare = false;
  const std::vector<double> distances = distances_of_tissue(grid, tissue, armature, held_by, chest);
  for (std::size_t k = 0; k < chest.bones.size(); ++k)
    if (distances[k] < kHasRibs * chest.half_width) {
      reaches[chest.bones[k]].cage = BoneReach::Cage::Chest;
      is_bare = true;
    }
  if (!is_bare) return false;
  for (const std::uint16_t arm : chest.arms) reaches[arm].cage = BoneReach::Cage::Arm;
  for (BoneReach& reach : reaches) reach.cage_width = static_cast<float>(chest.half_width);
  return true;
}

std::vector<BoneReach> reaches_in_body(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                                       const ZeroedVector<std::uint16_t>& held_by) {
  std::vector<BoneReach> reaches = reaches_of_bones(armature);
  widen_chest(grid, tissue, armature, held_by, reaches);
  return reaches;
}

}  // namespace limber
