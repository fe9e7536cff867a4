// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/joint_cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/bones/joint_surface.h"
#include "core/bones/min_cut.h"
#include "core/rig/joint_names.h"

namespace limber {

namespace {
constexpr double kReach = 0.6;      // of the shorter bone's length: how far along the bones a joint is looked at
constexpr double kReachAside = 0.3;  // of the longer one's: how far in any direction at least
constexpr double kShaft = 0.2;      // of the shorter one's: from there on what lies along a rig bone is surely that bone
constexpr double kShaftWidth = 0.1;  // of it: what lies along a rig bone, beyond what lies nearest to it
constexpr double kFarAside = 0.35;  // of a bone's length: nothing so far from a rig bone is its shaft
constexpr double kCoarse = 0.04;    // of the shorter bone's length: with voxels of this size the place of the joint counts twice as much
constexpr double kAway = 8;         // area counts as much more where the shafts begin, and four times that twice as far away
constexpr double kSteep = 0.4;      // of the way to where the shafts begin: from there on it counts more by the fourth power,
                                    // or the thin shaft beside a broad joint would be the cheapest place
constexpr double kSlender = 8;      // radii of the joint: shorter bones than that say less of where it is
constexpr double kSide = 0.6;       // of the shorter bone's length: how far apart bones may run that touch side by side
constexpr double kSideShaft = 0.5;  // of the distance to the other bone: what lies nearer to its own is surely of it
constexpr double kBroad = 1.5;      // times the thinner bone's cross-section: from there on a cut is not sure. Bones that touch at 1 to 3 mm
                                    // though their joints are open stay below it
constexpr double kMarrow = 4;       // times that area counts through marrow
constexpr double kBall = 0.02;      // of the bone's length: the smallest radius of the ball at its head
constexpr double kLargestBall = 0.1;
constexpr double kBallCore = 0.8;   // of the radius of a joint's ball: so much of it is surely the ball
constexpr double kBallWidth = 0.5;  // of it: in place of the distance to the shafts
constexpr double kSitsAlong = 0.25;  // of a bone's length from its head: where another bone may sit on it
constexpr double kClosed = 0.5;     // of a joint's cross-section: bones that touch in more are closed up there
constexpr double kJointReach = 0.15;  // of the parent's length: so far from the joint, at least, its radius is measured
constexpr double kJointSlice = 0.06;  // of the shorter bone's length: where the joint's radius is measured
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

class JointCutter {
 public:
  JointCutter(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds, const Armature& armature, const std::vector<std::int32_t>& group,
            const std::vector<std::vector<int>>& candidates)
      : graph_(graph), volume_(volume), kinds_(kinds), bones_(armature.bones), group_(group), candidates_(candidates), world_from_voxel_(world_from_voxel(volume.grid)),
        area_(areas_of_edges(volume.grid.spacing)), local_(graph.size(), -1) {
    std::vector<std::string> names;
    std::vector<int> parents;
    for (const Bone& bone : bones_) names.push_back(bone.name), parents.push_back(bone.parent);
    const std::vector<std::optional<JointRole>> roles = joint_roles(names, parents);
    for (int b = 0; b < std::ssize(bones_); ++b) {
      is_ball_.push_back(roles[b] && (roles[b]->part == BodyPart::Thigh || roles[b]->part == BodyPart::UpperArm));
      shape_.push_back(shape_of_joint(roles[b]));
    }
    find_nearest();
  }

  // Where a bone meets its parent; and where it sits on another child of that, nearer than on the parent itself, as a thumb
  // does that the rig hangs on the forearm beside the hand, also where it meets that one.
  void cut_joints_of(int child) {
    cut_joint(bones_[child].parent, child);
    if (const int other = bone_it_sits_on(child); other >= 0) cut_joint(other, child);
  }

  void cut_joint(int parent, int child) {
    const Bone &p = bones_[parent], &c = bones_[child];
    const double shorter = std::min(length_of(p), length_of(c)), longer = std::max(length_of(p), length_of(c));
    if (shorter <= 0) return;
    const glm::dvec3 joint = c.head, normal = normal_of_joint(p, c);
    const double reach = kReach * shorter, reach_aside = std::max(reach, kReachAside * longer);
    clear_domain();
    for (int which = 0; which < 2; ++which)
      for (const std::int32_t i : along_[which ? child : parent])
        if (const glm::dvec3 at = world(i); glm::distance(at, joint) <= reach_aside && std::abs(glm::dot(at - joint, normal)) <= reach) add(i, which);
    if (domain_.empty()) return;
    for (int which = 0; which < 2; ++which) find_shaft(which, which ? child : parent, joint, kShaft * shorter, kShaftWidth * shorter);
    const double ball = is_ball_[child] ? depth_at(joint, kLargestBall * length_of(c)) : 0;
    if (ball > kBall * length_of(c)) {
      for (Voxel& v : domain_)
        if (glm::distance(world(v.at), joint) < kBallCore * ball) v.shaft = 1;
      part(least_cut([&](std::int32_t, const glm::dvec3& at) {
        return weight_away((glm::distance(at, joint) - ball) / (kBallWidth * ball));
      }));
    } else {
      cut_across(normal, child, shorter);
    }
    const double shaft = (kReach - kShaft) * shorter;  // mm of it that lie in the domain
    if (cut_area_ > 0 && cut_area_ >= kBroad * std::min(volume_along(parent, 0, joint, kShaft * shorter), volume_along(child, 1, joint, kShaft * shorter)) / shaft) broad_.push_back({parent, child, cut_area_});
    tell_sides(parent, child);
  }

  // Where bones that have no joint lie side by side, as fingers do that are pushed together.
  void cut_sides() {
    std::map<std::pair<int, int>, std::vector<std::int32_t>> between;
    for (std::int32_t i = 0; i < graph_.size(); ++i) {
      const auto [a, b] = std::minmax(near_[i].bone[0], near_[i].bone[1]);
      if (b < 0 || a < 0 || bones_[a].parent == b || bones_[b].parent == a) continue;
      if (near_[i].distance[0] + near_[i].distance[1] <= kSide * std::min(length_of(bones_[a]), length_of(bones_[b]))) between[{a, b}].push_back(i);
    }
    for (const auto& [pair, voxels] : between) {
      clear_domain();
      for (const std::int32_t i : voxels) add(i, near_[i].bone[0] == pair.second);
      for (Voxel& v : domain_)
        if (v.is_allowed && near_[v.at].distance[0] < kSideShaft * near_[v.at].distance[1]) v.shaft = v.nearest;
      part(least_cut([&](std::int32_t i, const glm::dvec3&) {
        const auto& [nearest, next] = near_[i].distance;
        return weight_away((next - nearest) / (next + nearest));
      }));
    }
  }

  JointCuts cuts() && {
    if (depth_.empty())
      depth_ = bone_depth(graph_, volume_.grid.spacing);
    else
      lower_depth(graph_, volume_.grid.spacing, at_cuts_, depth_);
    return {std::move(beyond_), std::move(broad_), std::move(depth_)};
  }

 private:
  // The two rig bones that lie nearest to a voxel.
  struct Near {
    std::array<int, 2> bone{-1, -1};
    std::array<float, 2> distance{std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};  // mm
    void take(int b, float d) {
      if (d < distance[0]) {
        bone = {b, bone[0]};
        distance = {d, distance[0]};
      } else if (d < distance[1]) {
        bone[1] = b;
        distance[1] = d;
      }
    }
  };
  struct Voxel {
    std::int32_t at;  // in the graph
    int nearest;      // 0 or 1 of the two bones that are cut apart
    bool is_allowed;  // to follow that bone
    int shaft;        // 0, 1 or -1
  };

  // At a plane across the joint, or where its shape is known at that surface.
  void cut_across(const glm::dvec3& normal, int child, double shorter) {
    const glm::dvec3& joint = bones_[child].head;
    const glm::dvec3& spacing = volume_.grid.spacing;
    const double coarse = std::max({spacing.x, spacing.y, spacing.z}) / (kCoarse * shorter);
    const double scale = std::sqrt(1 + coarse * coarse) / (kShaft * shorter);
    const double slice = std::max({spacing.x, spacing.y, spacing.z});
    const double radius = radius_at(joint, normal, slice);
    const double steep = scale / kSteep * std::min(1.0, shorter / (kSlender * std::max(radius, slice)));
    const auto cut_along = [&](const JointSurface& surface, double sharp) {
      return least_cut([&](std::int32_t, const glm::dvec3& at) {
        const double height = surface.height_of(at), far = height * steep;
        return weight_away(height * scale * sharp) * (1 + far * far * far * far);
      });
    };
    const JointSurface surface = surface_at(normal, child, shorter);
    std::vector<std::uint8_t> side = cut_along(surface, 1);
    // Where the two are closed up, only the joint's own shape tells where one ends.
    const double section = std::numbers::pi * surface.radius * surface.radius;
    if (surface.shape.sharp > 1 && area_of(side) > kClosed * section) side = cut_along(surface, surface.shape.sharp);
    part(side);
  }

  int bone_it_sits_on(int child) const {
    const glm::dvec3& joint = bones_[child].head;
    int found = -1;
    double nearest = distance_to_bone(bones_[bones_[child].parent], joint);
    for (int b = 0; b < std::ssize(bones_); ++b) {
      if (b == child || bones_[b].parent != bones_[child].parent) continue;
      if (along_bone(bones_[b], joint) < kSitsAlong * length_of(bones_[b])) continue;
      if (const double d = distance_to_bone(bones_[b], joint); d < nearest) nearest = d, found = b;
    }
    return found;
  }

  // mm, of the bones of the domain in a slice across `axis` that is twice `half` mm thick.
  double radius_at(const glm::dvec3& joint, const glm::dvec3& axis, double half) const {
    const glm::dvec3& spacing = volume_.grid.spacing;
    const auto voxels = std::count_if(domain_.begin(), domain_.end(), [&](const Voxel& v) {
      return std::abs(glm::dot(world(v.at) - joint, axis)) < half;
    });
    return std::sqrt(double(voxels) * spacing.x * spacing.y * spacing.z / (2 * half) / std::numbers::pi);
  }
  JointSurface surface_at(const glm::dvec3& normal, int child, double shorter) const {
    const Bone& bone = bones_[child];
    const std::optional<JointShape>& shape = shape_[child];
    if (!shape) return flat_surface(bone.head, normal);
    const glm::dvec3& spacing = volume_.grid.spacing;
    const glm::dvec3 axis = glm::normalize(glm::mix(normal, glm::normalize(bone.tail - bone.head), shape->turn));
    std::vector<glm::dvec3> places;
    for (const Voxel& v : domain_) places.push_back(world(v.at));
    const double half = std::max({spacing.x, spacing.y, spacing.z, kJointSlice * shorter});
    const double reach = std::max(0.5 * shorter, kJointReach * length_of(bones_[bone.parent]));
    return surface_of_joint(*shape, bone.head, axis, places, spacing.x * spacing.y * spacing.z, half, reach,
                            std::min({spacing.x, spacing.y, spacing.z}));
  }

  void find_nearest() {
    std::vector<Bone> inner = bones_;  // bones share the point where they meet: away from it the direction decides
    for (Bone& bone : inner) bone.head = glm::mix(bone.head, bone.tail, 0.1), bone.tail = glm::mix(bone.head, bone.tail, 8.0 / 9);
    near_.resize(graph_.size());
    parallel_for(graph_.size(), 4096, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        const glm::dvec3 at = world(static_cast<std::int32_t>(i));
        for (int b = 0; b < std::ssize(inner); ++b) near_[i].take(b, static_cast<float>(distance_to_bone(inner[b], at)));
      }
    });
    along_.resize(bones_.size());
    for (std::int32_t i = 0; i < graph_.size(); ++i)
      if (near_[i].bone[0] >= 0) along_[near_[i].bone[0]].push_back(i);  // none where the rig is too far away for numbers
  }

  // The direction from the parent to the child across the plane that halves the angle between them, or the child's own where it
  // springs from the parent's side.
  static glm::dvec3 normal_of_joint(const Bone& parent, const Bone& child) {
    const glm::dvec3 along = glm::normalize(child.tail - child.head), of_parent = glm::normalize(parent.tail - parent.head);
    const glm::dvec3 on_parent = parent.head + along_bone(parent, child.head) * of_parent;
    if (glm::distance(on_parent, child.head) >= 0.1 * std::min(length_of(parent), length_of(child))) return along;
    const bool at_tail = glm::distance(child.head, parent.tail) <= glm::distance(child.head, parent.head);
    const glm::dvec3 halving = along + (at_tail ? of_parent : -of_parent);
    return glm::length(halving) > 0.3 ? glm::normalize(halving) : along;
  }

  void clear_domain() {
    for (const Voxel& v : domain_) local_[v.at] = -1;
    domain_.clear();
  }
  void add(std::int32_t i, int nearest) {
    const std::vector<int>& allowed = candidates_[group_[i]];
    local_[i] = static_cast<std::int32_t>(domain_.size());
    domain_.push_back({i, nearest, allowed.empty() || std::find(allowed.begin(), allowed.end(), near_[i].bone[0]) != allowed.end(), -1});
  }

  // What hangs on the shaft of one of the two bones cannot be of the other.
  void tell_sides(int a, int b) {
    for (int which = 0; which < 2; ++which)
      for (const std::int32_t i : reached_from(which)) beyond_.push_back({domain_[i].at, which ? a : b, which ? b : a});
  }

  // The shaft of one of the two bones: what lies nearest to it, in each of several slices along it, and no nearer to the
  // joint than `beginning`.
  void find_shaft(int which, int bone, const glm::dvec3& joint, double beginning, double width) {
    constexpr int kSlices = 16;
    const double length = length_of(bones_[bone]), at_joint = along_bone(bones_[bone], joint);
    std::array<float, kSlices + 1> nearest;
    nearest.fill(std::numeric_limits<float>::max());
    auto slice_of = [&](const Voxel& voxel) {
      if (voxel.nearest != which || !voxel.is_allowed) return -1;
      const double along = along_bone(bones_[bone], world(voxel.at));
      return std::abs(along - at_joint) >= beginning ? static_cast<int>(along / length * kSlices) : -1;
    };
    for (const Voxel& voxel : domain_)
      if (const int s = slice_of(voxel); s >= 0) nearest[s] = std::min(nearest[s], near_[voxel.at].distance[0]);
    for (Voxel& voxel : domain_)
      if (const int s = slice_of(voxel); s >= 0 && near_[voxel.at].distance[0] <= nearest[s] + width && nearest[s] < kFarAside * length) voxel.shaft = which;
  }

  // Of the bone tissue beside one of the two bones, no nearer to the joint than `beginning`; mm^3.
  double volume_along(int bone, int which, const glm::dvec3& joint, double beginning) const {
    const double at_joint = along_bone(bones_[bone], joint);
    const auto voxels = std::count_if(domain_.begin(), domain_.end(), [&](const Voxel& v) {
      return v.nearest == which && std::abs(along_bone(bones_[bone], world(v.at)) - at_joint) >= beginning;
    });
    const glm::dvec3& spacing = volume_.grid.spacing;
    return double(voxels) * spacing.x * spacing.y * spacing.z;
  }

  // Voxels of the domain connected with a shaft.
  std::vector<std::int32_t> reached_from(int which) const {
    std::vector<std::int32_t> front;
    std::vector<std::uint8_t> seen(domain_.size(), 0);
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i)
      if (domain_[i].shaft == which) front.push_back(i), seen[i] = 1;
    for (std::size_t k = 0; k < front.size(); ++k)
      for (const std::int32_t n : graph_.neighbour[domain_[front[k]].at]) {
        const std::int32_t m = n >= 0 ? local_[n] : -1;
        if (m >= 0 && !seen[m]) seen[m] = 1, front.push_back(m);
      }
    return front;
  }
  bool is_connected() const {
    const std::vector<std::int32_t> reached = reached_from(0);
    return std::any_of(reached.begin(), reached.end(), [&](std::int32_t i) { return domain_[i].shaft == 1; });
  }

  // How many times its area a place counts.
  //   off  from the surface where the two ought to part; 1 where the shafts begin
  static double weight_away(double off) { return 1 + kAway * off * off; }

  // #domain, 1 on the side of the first of the two bones; empty where nothing connects their shafts.
  //   weight  (voxel, world) how many times its area a place counts
  std::vector<std::uint8_t> least_cut(const auto& weight) {
    if (!is_connected()) return {};
    if (depth_.empty()) depth_ = bone_depth(graph_, volume_.grid.spacing);
    CutGraph<26> cut;
    cut.neighbour.resize(domain_.size());
    cut.capacity.resize(domain_.size());
    cut.terminal.resize(domain_.size());
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i) {
      cut.terminal[i] = domain_[i].shaft == 0 ? kHard : domain_[i].shaft == 1 ? -kHard : 0;
      for (int k = 0; k < 26; ++k) {
        const std::int32_t n = graph_.neighbour[domain_[i].at][k];
        const std::int32_t m = cut.neighbour[i][k] = n >= 0 ? local_[n] : -1;
        if (m < i) continue;
        const double times = weight(domain_[i].at, (world(domain_[i].at) + world(n)) / 2.0);
        double cost = area_[k] * times * (depth_[domain_[i].at] + depth_[n]) / 2;
        if (is_marrow(domain_[i].at) && is_marrow(n)) cost *= kMarrow;
        cut.capacity[i][k] = cut.capacity[m][25 - k] = static_cast<std::int32_t>(std::clamp(1000 * cost, 1.0, double(kHard)));
      }
    }
    return min_cut(std::move(cut));
  }
  // mm^2 of the contact between the two sides.
  double area_of(const std::vector<std::uint8_t>& side) const {
    double area = 0;
    for (std::int32_t i = 0; i < std::ssize(side); ++i)
      for (int k = 0; k < 26; ++k) {
        const std::int32_t n = graph_.neighbour[domain_[i].at][k];
        if (n >= 0 && local_[n] >= 0 && side[local_[n]] != side[i]) area += area_[k] / 2;  // the neighbour counts the other half
      }
    return area;
  }
  void part(const std::vector<std::uint8_t>& side) {
    cut_area_ = area_of(side);
    for (std::int32_t i = 0; i < std::ssize(side); ++i) {
      bool is_cut = false;
      for (int k = 0; k < 26; ++k) {
        std::int32_t& n = graph_.neighbour[domain_[i].at][k];
        if (n < 0 || local_[n] < 0 || side[local_[n]] == side[i]) continue;
        n = kNotBone;
        is_cut = true;
      }
      if (is_cut) at_cuts_.push_back(domain_[i].at);
    }
  }

  // Distance in mm from a point to the nearest voxel that is not bone, at most `most`.
  double depth_at(const glm::dvec3& point, double most) const {
    const glm::dvec3 centre = voxel_from_world(volume_.grid) * point;
    const glm::dvec3 first(-1), last(volume_.grid.size);  // the air around the grid included
    const glm::ivec3 low(glm::clamp(glm::floor(centre - most / volume_.grid.spacing), first, last));
    const glm::ivec3 high(glm::clamp(glm::ceil(centre + most / volume_.grid.spacing), first, last));
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
  std::vector<Near> near_;                        // #graph
  std::vector<std::vector<std::int32_t>> along_;  // by rig bone: the voxels nearest to it
  std::vector<bool> is_ball_;  // by rig bone: its head is the centre of a ball
  std::vector<std::optional<JointShape>> shape_;  // by rig bone: of the joint at its head
  std::vector<float> depth_;  // #graph, mm, before the cuts; found when the first cut needs it
  std::vector<std::int32_t> local_;  // #graph, in `domain_` or -1
  std::vector<Voxel> domain_;
  std::vector<BeyondJoint> beyond_;
  std::vector<BroadCut> broad_;
  double cut_area_ = 0;  // of the last cut, mm^2
  std::vector<std::int32_t> at_cuts_;  // voxels that lost connections
};
}  // namespace

JointCuts cut_at_joints(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds, const Armature& armature,
                   const std::vector<std::int32_t>& group, const std::vector<std::vector<int>>& candidates, Progress& progress) {
  JointCutter cutter(graph, volume, kinds, armature, group, candidates);
  for (int child = 0; child < std::ssize(armature.bones); ++child) {
    progress.update("bones", 0.4);
    if (armature.bones[child].parent >= 0) cutter.cut_joints_of(child);
  }
  cutter.cut_sides();
  return std::move(cutter).cuts();
}
}  // namespace limber
