// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/joint_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/bones/min_cut.h"
#include "core/rig/joint_names.h"

namespace limber {

namespace {
constexpr double kReach = 0.6;      // of the shorter bone's length: how far along the bones a joint is looked at
constexpr double kReachAside = 0.3;  // of the longer one's: how far in any direction at least
constexpr double kShaft = 0.2;      // of the shorter one's: from there on what lies along a rig bone is surely that bone
constexpr double kShaftWidth = 0.1;  // of it: what lies along a rig bone, beyond what lies nearest to it
constexpr double kFarAside = 0.35;  // of a bone's length: nothing so far from a rig bone is its shaft
constexpr double kAway = 30;        // area counts as much more where the shafts begin, and four times that twice as far away
constexpr double kMarrow = 4;       // times that area counts through marrow
constexpr double kBall = 0.02;      // of the bone's length: the smallest radius of the ball at its head
constexpr double kLargestBall = 0.1;
constexpr double kBallCore = 0.8;   // of the radius of a joint's ball: so much of it is surely the ball
constexpr double kBallWidth = 0.5;  // of it: in place of the distance to the shafts
constexpr std::int32_t kHard = 1 << 28;

// Area in mm^2 that a cut through the edge to each of the 26 neighbours stands for.
std::array<double, 26> areas_of_edges(const glm::dvec3& spacing) {
  std::array<glm::dvec3, 26> edge;
  int count = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (x || y || z) edge[count++] = glm::dvec3(x, y, z) * spacing;
  std::array<double, 26> share{};
  constexpr int kDirections = 20000;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, turn = i * std::numbers::pi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    const glm::dvec3 direction(r * std::cos(turn), r * std::sin(turn), z);
    int nearest = 0;
    double most = -1;
    for (int k = 0; k < 13; ++k)
      if (const double along = std::abs(glm::dot(direction, edge[k])) / glm::length(edge[k]); along > most) most = along, nearest = k;
    share[nearest] += 2.0 / kDirections;  // of the half sphere's solid angle, 2 pi, over pi
  }
  std::array<double, 26> area;
  for (int k = 0; k < 13; ++k) area[k] = area[25 - k] = share[k] * spacing.x * spacing.y * spacing.z / glm::length(edge[k]);
  return area;
}

double length_of(const Bone& bone) { return glm::length(bone.tail - bone.head); }
// Where along the bone the point nearest to p lies, mm from its head.
double along_bone(const Bone& bone, const glm::dvec3& p) {
  const double length = length_of(bone);
  return length > 0 ? std::clamp(glm::dot(p - bone.head, (bone.tail - bone.head) / length), 0.0, length) : 0;
}

class JointCuts {
 public:
  JointCuts(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds, const Armature& armature, const std::vector<std::int32_t>& group,
            const std::vector<std::vector<int>>& candidates)
      : graph_(graph), volume_(volume), kinds_(kinds), bones_(armature.bones), group_(group), candidates_(candidates), world_from_voxel_(world_from_voxel(volume.grid)),
        area_(areas_of_edges(volume.grid.spacing)), local_(graph.size(), -1) {
    for (const Bone& bone : bones_) {
      Bone inner = bone;
      inner.head = glm::mix(bone.head, bone.tail, 0.1);
      inner.tail = glm::mix(bone.head, bone.tail, 0.9);
      inner_.push_back(inner);
    }
    std::vector<std::string> names;
    std::vector<int> parents;
    for (const Bone& bone : bones_) names.push_back(bone.name), parents.push_back(bone.parent);
    for (const auto& role : joint_roles(names, parents)) is_ball_.push_back(role && (role->part == BodyPart::Thigh || role->part == BodyPart::UpperArm));
  }

  // Where a bone meets its parent.
  void cut_joint(int child) {
    const int parent = bones_[child].parent;
    const Bone &p = bones_[parent], &c = bones_[child];
    const double shorter = std::min(length_of(p), length_of(c)), longer = std::max(length_of(p), length_of(c));
    if (shorter <= 0) return;
    const glm::dvec3 joint = c.head;
    const glm::dvec3 on_parent = p.head + along_bone(p, joint) / length_of(p) * (p.tail - p.head);
    glm::dvec3 normal = glm::normalize(c.tail - c.head);
    if (glm::distance(on_parent, joint) < 0.1 * shorter) {
      const bool at_tail = glm::distance(joint, p.tail) <= glm::distance(joint, p.head);
      const glm::dvec3 bisecting = normal + glm::normalize(at_tail ? p.tail - p.head : p.head - p.tail);
      if (glm::length(bisecting) > 0.3) normal = glm::normalize(bisecting);
    }
    const double reach = kReach * shorter;
    gather(parent, child, joint, std::max(reach, kReachAside * longer), [&](const glm::dvec3& at) { return std::abs(glm::dot(at - joint, normal)) <= reach; });
    find_core(0, parent, joint, kShaft * shorter, kShaftWidth * shorter);
    find_core(1, child, joint, kShaft * shorter, kShaftWidth * shorter);
    const double ball = is_ball_[child] ? depth_at(joint, kLargestBall * length_of(c)) : 0;
    if (ball > kBall * length_of(c)) {
      for (Voxel& v : domain_)
        if (glm::distance(world(v.at), joint) < kBallCore * ball) v.core = 1;
      if (is_connected()) cut([&](const glm::dvec3& at) { return (glm::distance(at, joint) - ball) / (kBallWidth * ball); });
    } else {
      if (is_connected()) cut([&](const glm::dvec3& at) { return glm::dot(at - joint, normal) / (kShaft * shorter); });
    }
    tell_sides(parent, child);
  }

  std::vector<BeyondJoint> beyond() && { return std::move(beyond_); }

 private:
  struct Voxel {
    std::int32_t at;  // in the graph
    std::array<double, 2> distance;
    int nearest;  // 0 or 1
    bool is_allowed;  // to follow the nearest
    int core;  // 0, 1 or -1
  };

  void gather(int a, int b, const glm::dvec3& centre, double radius, const auto& is_inside) {
    for (const Voxel& v : domain_) local_[v.at] = -1;
    domain_.clear();
    std::vector<int> others;
    for (int other = 0; other < std::ssize(bones_); ++other)
      if (other != a && other != b && distance_to_bone(inner_[other], centre) < 2 * radius) others.push_back(other);
    for (std::int32_t i = 0; i < graph_.size(); ++i) {
      const glm::dvec3 at = world(i);
      if (glm::distance(at, centre) > radius || !is_inside(at)) continue;
      Voxel voxel{i, {distance_to_bone(inner_[a], at), distance_to_bone(inner_[b], at)}, 0, true, -1};
      voxel.nearest = voxel.distance[1] < voxel.distance[0];
      double elsewhere = std::numeric_limits<double>::max();
      for (int other : others) elsewhere = std::min(elsewhere, distance_to_bone(inner_[other], at));
      if (elsewhere < voxel.distance[voxel.nearest]) continue;
      const std::vector<int>& allowed = candidates_[group_[i]];
      voxel.is_allowed = allowed.empty() || std::find(allowed.begin(), allowed.end(), voxel.nearest ? b : a) != allowed.end();
      local_[i] = static_cast<std::int32_t>(domain_.size());
      domain_.push_back(voxel);
    }
  }

  // What hangs on one core cannot be of the other core's bone.
  void tell_sides(int a, int b) {
    for (int which = 0; which < 2; ++which)
      for (const std::int32_t i : reached_from(which)) beyond_.push_back({domain_[i].at, which ? a : b});
  }

  // The shaft of one of the two bones: what lies nearest to it, in each of several slices along it, and no further away from
  // the joint than `beginning`.
  void find_core(int which, int bone, const glm::dvec3& joint, double beginning, double width) {
    constexpr int kSlices = 16;
    const double length = length_of(bones_[bone]), at_joint = along_bone(bones_[bone], joint);
    std::array<double, kSlices + 1> nearest;
    nearest.fill(std::numeric_limits<double>::max());
    auto slice_of = [&](const Voxel& voxel) {
      if (voxel.nearest != which || !voxel.is_allowed) return -1;
      const double along = along_bone(bones_[bone], world(voxel.at));
      return std::abs(along - at_joint) >= beginning ? static_cast<int>(along / length * kSlices) : -1;
    };
    for (const Voxel& voxel : domain_)
      if (const int s = slice_of(voxel); s >= 0) nearest[s] = std::min(nearest[s], voxel.distance[which]);
    for (Voxel& voxel : domain_)
      if (const int s = slice_of(voxel); s >= 0 && voxel.distance[which] <= nearest[s] + width && nearest[s] < kFarAside * length) voxel.core = which;
  }

  // Voxels of the domain connected with a core.
  std::vector<std::int32_t> reached_from(int which) const {
    std::vector<std::int32_t> front;
    std::vector<std::uint8_t> seen(domain_.size(), 0);
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i)
      if (domain_[i].core == which) front.push_back(i), seen[i] = 1;
    for (std::size_t k = 0; k < front.size(); ++k)
      for (const std::int32_t n : graph_.neighbour[domain_[front[k]].at]) {
        const std::int32_t m = n >= 0 ? local_[n] : -1;
        if (m >= 0 && !seen[m]) seen[m] = 1, front.push_back(m);
      }
    return front;
  }
  bool is_connected() const {
    const std::vector<std::int32_t> reached = reached_from(0);
    return std::any_of(reached.begin(), reached.end(), [&](std::int32_t i) { return domain_[i].core == 1; });
  }

  //   away  how far a place lies from the surface where the two ought to part; 1 at the beginning of the shafts
  void cut(const auto& away) {
    CutGraph cut;
    cut.neighbour.resize(domain_.size());
    cut.capacity.resize(domain_.size());
    cut.terminal.resize(domain_.size());
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i) {
      cut.terminal[i] = domain_[i].core == 0 ? kHard : domain_[i].core == 1 ? -kHard : 0;
      for (int k = 0; k < 26; ++k) {
        const std::int32_t n = graph_.neighbour[domain_[i].at][k];
        const std::int32_t m = cut.neighbour[i][k] = n >= 0 ? local_[n] : -1;
        if (m < i) continue;
        const double off = away((world(domain_[i].at) + world(n)) / 2.0);
        double cost = area_[k] * (1 + kAway * off * off);
        if (is_marrow(domain_[i].at) && is_marrow(n)) cost *= kMarrow;
        cut.capacity[i][k] = cut.capacity[m][25 - k] = static_cast<std::int32_t>(std::clamp(1000 * cost, 1.0, double(kHard)));
      }
    }
    const std::vector<std::uint8_t> side = min_cut(std::move(cut));
    severed_ = 0;
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i)
      for (std::int32_t& n : graph_.neighbour[domain_[i].at])
        if (n >= 0 && local_[n] >= 0 && side[local_[n]] != side[i]) n = kNotBone, ++severed_;
  }

  // Distance in mm from a point to the nearest voxel that is not bone, at most `most`.
  double depth_at(const glm::dvec3& point, double most) const {
    const glm::dvec3 centre = voxel_from_world(volume_.grid) * point;
    const glm::ivec3 low(glm::floor(centre - most / volume_.grid.spacing)), high(glm::ceil(centre + most / volume_.grid.spacing));
    double nearest = most;
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          if (!is_bone(kinds_[volume_.at_or_air({x, y, z})])) nearest = std::min(nearest, glm::length((glm::dvec3(x, y, z) - centre) * volume_.grid.spacing));
    return nearest;
  }
  bool is_marrow(std::int32_t i) const { return kinds_[volume_.at(graph_.voxel[i])] == TissueKind::Marrow; }
  glm::dvec3 world(std::int32_t i) const { return world_from_voxel_ * glm::dvec3(graph_.voxel[i]); }

  BoneGraph& graph_;
  const LabelVolume& volume_;
  const std::vector<TissueKind>& kinds_;
  const std::vector<Bone>& bones_;
  const std::vector<std::int32_t>& group_;
  const std::vector<std::vector<int>>& candidates_;
  AffineTransform world_from_voxel_;
  std::array<double, 26> area_;
  std::vector<Bone> inner_;
  std::vector<bool> is_ball_;  // by rig bone: its head is the centre of a ball
  std::vector<std::int32_t> local_;  // #graph, in `domain_` or -1
  std::vector<Voxel> domain_;
  std::vector<BeyondJoint> beyond_;
  int severed_ = 0;
};
}  // namespace

std::vector<BeyondJoint> cut_at_joints(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds, const Armature& armature,
                   const std::vector<std::int32_t>& group, const std::vector<std::vector<int>>& candidates, Progress& progress) {
  JointCuts cuts(graph, volume, kinds, armature, group, candidates);
  for (int child = 0; child < std::ssize(armature.bones); ++child) {
    progress.update("bones", 0.4);
    if (armature.bones[child].parent >= 0) cuts.cut_joint(child);
  }
  return std::move(cuts).beyond();
}
}  // namespace limber
