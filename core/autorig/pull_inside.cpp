// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/pull_inside.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/autorig/rig_check.h"

namespace limber {

namespace {

// A joint is shifted at most by kShare times the length of every bone that begins or ends at it, and by at most kMost
// mm.
constexpr double kShare = 0.5, kMost = 30;
constexpr int kRounds = 60;
// The search for tissue tests at most this many positions in each direction; if voxels are small, it skips some of
// them.
constexpr int kMostSteps = 20;
constexpr double kSlide = 0.6;  // cost of a shift along a free hinge's axis, relative to a shift across it

// Returns the cost of a joint's shift, mm. A shift along a hinge's axis costs less than one across it, since the hinge
// rotates its bone in the same way at every position on the axis.
double harm(const glm::dvec3& shift, const glm::dvec3& axis) {
  const double along = glm::dot(shift, axis);
  return std::sqrt(std::max(0.0, glm::dot(shift, shift) - (1 - kSlide * kSlide) * along * along));
}

// Finds the tissue voxel to which a point can be shifted with the least cost, harm(). Prefers voxels that have tissue
// on all six sides.
class Nearest {
 public:
  //   slide  unit axis of a free hinge (a hinge that shares no joint with another bone), or zero
  Nearest(const LabelVolume& volume, const glm::dvec3& slide)
      : volume_(volume),
        to_voxel_(voxel_from_world(volume.grid)),
        to_world_(world_from_voxel(volume.grid)) {
    const glm::dvec3 spacing = volume.grid.spacing;
    const double farthest = slide == glm::dvec3(0) ? kMost : kMost / kSlide;
    glm::ivec3 count, stride;
    for (int axis = 0; axis < 3; ++axis) {
      const int voxels = static_cast<int>(std::min(farthest / spacing[axis], 1e6));
      stride[axis] = std::max(1, (voxels + kMostSteps - 1) / kMostSteps);
      count[axis] = voxels / stride[axis];
    }
    for (int z = -count.z; z <= count.z; ++z)
      for (int y = -count.y; y <= count.y; ++y)
        for (int x = -count.x; x <= count.x; ++x) {
          const glm::ivec3 step = glm::ivec3(x, y, z) * stride;
          if (const double d = harm(volume.grid.direction * (glm::dvec3(step) * spacing), slide); d <= kMost)
            steps_.push_back({d, step});
        }
    std::stable_sort(steps_.begin(), steps_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }

  std::optional<glm::dvec3> operator()(const glm::dvec3& place) const {
    const glm::dvec3 at = glm::floor(to_voxel_ * place + 0.5);
    if (glm::any(glm::greaterThan(glm::abs(at), glm::dvec3(1e8)))) return std::nullopt;
    std::optional<glm::ivec3> shallow;
    for (const auto& [distance, step] : steps_) {
      const glm::ivec3 voxel = glm::ivec3(at) + step;
      if (!tissue(voxel)) continue;
      if (is_deep(voxel)) return to_world_ * glm::dvec3(voxel);
      if (!shallow) shallow = voxel;
    }
    return shallow ? std::optional(to_world_ * glm::dvec3(*shallow)) : std::nullopt;
  }

 private:
  bool tissue(const glm::ivec3& voxel) const { return volume_.grid.contains(voxel) && volume_.at(voxel) != 0; }
  bool is_deep(const glm::ivec3& voxel) const {
    for (int axis = 0; axis < 3; ++axis)
      for (int side : {-1, 1}) {
        glm::ivec3 beside = voxel;
        beside[axis] += side;
        if (!tissue(beside)) return false;
      }
    return true;
  }

  const LabelVolume& volume_;
  AffineTransform to_voxel_, to_world_;
  std::vector<std::pair<double, glm::ivec3>> steps_;
};

// A point at which one or more bones begin or end.
struct Joint {
  glm::dvec3 start{0}, place{0};
  double reach = kMost;
  int uses = 0;         // number of bones that begin or end at this joint
  glm::dvec3 slide{0};  // axis of a free hinge (which shares no joint with another bone); zero: none
  glm::dvec3 pull{0};
  int pulls = 0;
};

}  // namespace

Armature drawn_inside(const Armature& rig, const LabelVolume& volume, const std::vector<TissueCut>& cuts,
                      const std::vector<double>& free) {
  RigCheck check = check_rig(volume, rig);
  if (check.leaving.empty() && check.outside.empty()) return rig;

  std::vector<Joint> joints;
  std::map<std::array<double, 3>, int> known;
  const auto joint_at = [&](const glm::dvec3& place, double reach) {
    const auto [found, is_new] = known.insert({{place.x, place.y, place.z}, static_cast<int>(joints.size())});
    if (is_new) joints.push_back({.start = place, .place = place});
    joints[found->second].reach = std::min(joints[found->second].reach, reach);
    ++joints[found->second].uses;
    return found->second;
  };
  std::vector<std::array<int, 2>> ends;
  for (size_t b = 0; b < rig.bones.size(); ++b) {
    const Bone& bone = rig.bones[b];
    const double reach = kShare * glm::distance(bone.head, bone.tail);
    const int head = joint_at(bone.head, std::min(reach, free[b]));
    ends.push_back({head, joint_at(bone.tail, reach)});
  }

  // The searches for the nearest tissue, by bone. A bone that is a free hinge has its own search; the entry -1 is used
  // for all other bones.
  std::map<int, Nearest> nearest;
  nearest.emplace(-1, Nearest(volume, glm::dvec3(0)));
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    const JointLimits& limits = rig.bones[b].limits;
    Joint &head = joints[ends[b][0]], &tail = joints[ends[b][1]];
    const bool is_free =
        limits.type == JointLimits::Type::Hinge && head.uses == 1 && tail.uses == 1 && check.share[b] < 1;
    if (!is_free) continue;
    head.slide = tail.slide = limits.axis;
    nearest.emplace(b, Nearest(volume, limits.axis));
  }
  Armature best = rig, moved = rig;
  double most = check.whole;
  for (int round = 0; round < kRounds; ++round) {
    const auto pull = [&](int bone, double along) {
      const auto& [head, tail] = ends[bone];
      const glm::dvec3 place = glm::mix(joints[head].place, joints[tail].place, along);
      if (beyond(cuts, place) > 0) return;
      const auto own = nearest.find(bone);
      const auto goal = (own != nearest.end() ? own->second : nearest.at(-1))(place);
      if (!goal) return;
      const glm::dvec3 by = (*goal - place) / ((1 - along) * (1 - along) + along * along);
      for (const auto& [joint, lever] : {std::pair(head, 1 - along), std::pair(tail, along)})
        if (lever > 0) joints[joint].pull += lever * by, ++joints[joint].pulls;
    };
    for (const auto& leaving : check.leaving) pull(leaving.bone, (leaving.from + leaving.to) / 2);
    for (const auto& outside : check.outside) pull(outside.bone, outside.tail ? 1 : 0);

    for (Joint& joint : joints) {
      if (joint.pulls == 0) continue;
      const glm::dvec3 off = joint.place + joint.pull / double(joint.pulls) - joint.start;
      joint.place = joint.start + off * std::min(1.0, joint.reach / std::max(joint.reach, harm(off, joint.slide)));
      joint.pull = glm::dvec3(0), joint.pulls = 0;
    }
    for (size_t b = 0; b < rig.bones.size(); ++b) {
      moved.bones[b].head = joints[ends[b][0]].place;
      moved.bones[b].tail = joints[ends[b][1]].place;
    }
    check = check_rig(volume, moved);
    if (check.whole > most) most = check.whole, best = moved;
    if (check.leaving.empty() && check.outside.empty()) return moved;
  }
  // A bone that leaves the tissue may be shortened if no other bone begins at its tail.
  check = check_rig(volume, best);
  for (const auto& leaving : check.leaving) {
    Bone& bone = best.bones[leaving.bone];
    const bool is_end = leaving.to == 1 && joints[ends[leaving.bone][1]].uses == 1 && beyond(cuts, leaving.place) <= 0;
    if (is_end && leaving.from >= kShare) bone.tail = glm::mix(bone.head, bone.tail, leaving.from);
  }
  return best;
}

}  // namespace limber
