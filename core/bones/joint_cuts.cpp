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
// Limits of cuts at joints, as shares of the shorter or longer of a joint's two rig bones. A joint's domain is the set
// of voxels in which its cut is searched. A shaft is the tissue along a rig bone that certainly belongs to the bone.
constexpr double kReach = 0.6;       // reach of a joint's domain along the bones, share of the shorter bone
constexpr double kReachAside = 0.3;  // smallest reach of a joint's domain in any direction, share of the longer bone
constexpr double kShaft = 0.2;       // distance from the joint at which the shafts begin, share of the shorter bone
// Tissue up to this much further from a rig bone than the nearest tissue is shaft too; share of the shorter bone.
constexpr double kShaftWidth = 0.1;
constexpr double kFarAside = 0.35;  // tissue further than this from a bone is never its shaft, share of its length
// Voxel size at which squared distances from the expected cut count twice; share of the shorter bone.
constexpr double kCoarse = 0.04;
// Where the shafts begin, cut area weighs 1 + this; the addition grows with the squared distance from the expected cut.
constexpr double kAway = 8;
// Beyond this distance from the expected cut, as a share of the distance to the shafts, the weight of cut area rises
// with the fourth power of the distance. Otherwise the thin shaft beside a broad joint would be the cheapest cut.
constexpr double kSteep = 0.4;
// If a rig bone is shorter than this number of joint radii, the weight of cut area rises less steeply, since a short
// rig bone determines the position of the joint less exactly.
constexpr double kSlender = 8;
constexpr double kSide = 0.6;  // bones further apart than this are not cut at their sides, share of the shorter bone
// A voxel certainly belongs to its nearest bone if the ratio of its distances to the nearest and to the second nearest
// bone is below this.
constexpr double kSideShaft = 0.5;
// A cut is uncertain if the ratio of its area to the thinner bone's cross-section is at least this. Bones with open
// joints, even if they touch in scans of 1 to 3 mm, have smaller ratios.
constexpr double kBroad = 1.5;
constexpr double kMarrow = 4;   // factor on the weight of cut area through marrow
constexpr double kBall = 0.02;  // a spherical bone head with a smaller radius is ignored; share of the bone's length
// A larger radius of a spherical head is lowered to this; share of the bone's length.
constexpr double kLargestBall = 0.1;
// Tissue within this share of a spherical head's radius certainly belongs to the head.
constexpr double kBallCore = 0.8;
// Distance beyond a spherical head, in its radii, at which cut area weighs 1 + kAway, as where shafts begin.
constexpr double kBallWidth = 0.5;
// A bone counts as attached along a sibling (another child of its parent) only if the sibling's point nearest to the
// bone's head is at least this share of the sibling's length away from the sibling's head.
constexpr double kSitsAlong = 0.25;
constexpr double kClosed = 0.5;  // contact area above which bones count as fused, share of the joint's cross-section
constexpr double kJointReach = 0.15;  // a joint's shape is measured at least within this distance; share of the parent
constexpr double kJointSlice = 0.06;  // half thickness of the slice that measures a joint, share of the shorter bone
constexpr std::int32_t kHard = 1 << 28;

// Returns, for the edge to each of the 26 neighbours of a voxel, the area, mm^2, that a cut through this edge counts
// as.
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
    const double z = 1 - (2 * i + 1.0) / kDirections, turn = i * std::numbers::pi * (3 - std::sqrt(5.0)),
                 r = std::sqrt(1 - z * z);
    const glm::dvec3 direction(r * std::cos(turn), r * std::sin(turn), z);
    int nearest = 0;
    double most = -1;
    for (int k = 0; k < 13; ++k)
      if (const double along = std::abs(glm::dot(direction, edge[k])) / glm::length(edge[k]); along > most)
        most = along, nearest = k;
    share[nearest] += 2.0 / kDirections;  // share of the half sphere's solid angle (2 pi), divided by pi
  }
  std::array<double, 26> area;
  for (int k = 0; k < 13; ++k)
    area[k] = area[25 - k] = share[k] * spacing.x * spacing.y * spacing.z / glm::length(edge[k]);
  return area;
}

double length_of(const Bone& bone) { return glm::length(bone.tail - bone.head); }
// Returns the distance from a bone's head, along the bone, to the point of the bone that is nearest to `p`, mm.
double along_bone(const Bone& bone, const glm::dvec3& p) {
  const double length = length_of(bone);
  return length > 0 ? std::clamp(glm::dot(p - bone.head, (bone.tail - bone.head) / length), 0.0, length) : 0;
}

// The two rig bones nearest to a voxel. `rank` is the voxel's index among the voxels that have the same nearest bone.
struct Near {
  std::array<int, 2> bone{-1, -1};
  std::array<float, 2> distance{std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};  // each in mm
  std::int32_t rank = -1;
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

// The data that all cuts share. A cut is computed in its domain, a set of voxels around a joint, and changes an edge
// between two voxels only if both are in the domain.
struct Scene {
  BoneGraph& graph;
  const LabelVolume& volume;
  const std::vector<TissueKind>& kinds;
  const std::vector<Bone>& bones;
  const std::vector<std::int32_t>& group;
  const std::vector<std::vector<int>>& candidates;
  AffineTransform world_from_voxel;
  std::array<double, 26> area;
  std::vector<float> depth;                      // depth of each voxel of the graph inside its bone before the cuts, mm
  std::vector<Near> near;                        // the nearest rig bones of each voxel of the graph
  std::vector<std::vector<std::int32_t>> along;  // for each rig bone, the voxels to which it is the nearest bone
  std::vector<bool> is_ball;                     // for each rig bone, true: its head is the centre of a ball joint
  std::vector<std::optional<JointShape>> shape;  // for each rig bone, the shape of the joint at its head; none: unknown

  glm::dvec3 world(std::int32_t i) const { return world_from_voxel * glm::dvec3(graph.voxel[i]); }
  bool is_marrow(std::int32_t i) const { return kinds[volume.at(graph.voxel[i])] == TissueKind::Marrow; }
  // Returns the distance from a point to the nearest voxel that is not bone, mm, but at most `most`.
  double depth_at(const glm::dvec3& point, double most) const {
    const glm::dvec3 centre = voxel_from_world(volume.grid) * point;
    const glm::dvec3 first(-1), last(volume.grid.size);  // range of voxels, including one layer of air around the grid
    const glm::ivec3 low(glm::clamp(glm::floor(centre - most / volume.grid.spacing), first, last));
    const glm::ivec3 high(glm::clamp(glm::ceil(centre + most / volume.grid.spacing), first, last));
    double nearest = most;
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          if (!is_bone(kinds[volume.at_or_air({x, y, z})]))
            nearest = std::min(nearest, glm::length((glm::dvec3(x, y, z) - centre) * volume.grid.spacing));
    return nearest;
  }
};

// The result of one cut between two rig bones.
struct Found {
  std::vector<BeyondJoint> beyond;
  std::optional<BroadCut> broad;
  std::vector<std::int32_t> at_cuts;  // voxels that lost connections by the cut
};

// One cut between two rig bones. Its domain (the voxels that it may separate) contains only voxels whose nearest rig
// bone is one of the two. The cut reads and changes only edges inside the domain, so cuts that share no rig bone may
// run in parallel.
class Cut {
 public:
  Cut(Scene& scene, int first, int second) : scene_(scene), bones_(scene.bones), bone_{first, second} {}

  // Cuts between a parent bone and its child at their joint, which is the child's head.
  Found at_joint() && {
    const auto [parent, child] = bone_;
    const Bone &p = bones_[parent], &c = bones_[child];
    const double shorter = std::min(length_of(p), length_of(c)), longer = std::max(length_of(p), length_of(c));
    if (shorter <= 0) return {};
    const glm::dvec3 joint = c.head, normal = normal_of_joint(p, c);
    const double reach = kReach * shorter, reach_aside = std::max(reach, kReachAside * longer);
    for (int which = 0; which < 2; ++which)
      for (const std::int32_t i : scene_.along[bone_[which]])
        if (const glm::dvec3 at = world(i);
            glm::distance(at, joint) <= reach_aside && std::abs(glm::dot(at - joint, normal)) <= reach)
          add(i);
    if (domain_.empty()) return {};
    link();
    for (int which = 0; which < 2; ++which) find_shaft(which, joint, kShaft * shorter, kShaftWidth * shorter);
    const double ball = scene_.is_ball[child] ? scene_.depth_at(joint, kLargestBall * length_of(c)) : 0;
    if (ball > kBall * length_of(c)) {
      for (Voxel& v : domain_)
        if (glm::distance(world(v.at), joint) < kBallCore * ball) v.shaft = 1;
      part(least_cut([&](std::int32_t, const glm::dvec3& at) {
        return weight_away((glm::distance(at, joint) - ball) / (kBallWidth * ball));
      }));
    } else {
      cut_across(normal, shorter);
    }
    // Length of the part of each shaft that is inside the domain, mm.
    const double shaft = (kReach - kShaft) * shorter;
    const double thinner =
        std::min(volume_along(0, joint, kShaft * shorter), volume_along(1, joint, kShaft * shorter)) / shaft;
    if (cut_area_ > 0 && cut_area_ >= kBroad * thinner) found_.broad = BroadCut{parent, child, cut_area_};
    tell_sides();
    return std::move(found_);
  }

  // Cuts between two bones that lie side by side without a joint.
  //   voxels  voxels whose two nearest rig bones are these two
  Found side_by_side(const std::vector<std::int32_t>& voxels) && {
    for (const std::int32_t i : voxels) add(i);
    link();
    const std::vector<Near>& near = scene_.near;
    for (Voxel& v : domain_)
      if (v.is_allowed && near[v.at].distance[0] < kSideShaft * near[v.at].distance[1]) v.shaft = v.nearest;
    part(least_cut([&](std::int32_t i, const glm::dvec3&) {
      const auto& [nearest, next] = near[i].distance;
      return weight_away((next - nearest) / (next + nearest));
    }));
    return std::move(found_);
  }

 private:
  struct Voxel {
    std::int32_t at;  // index of the voxel in the graph
    int nearest;      // 0 or 1: the nearer one of the two bones
    bool is_allowed;  // true: the voxel may follow the bone that `nearest` names
    int shaft;        // 0 or 1: the bone whose shaft holds the voxel; -1: none
  };

  // Cuts near the plane across the joint or, if the joint's anatomical shape is known, near its anatomical surface.
  void cut_across(const glm::dvec3& normal, double shorter) {
    const glm::dvec3& joint = bones_[bone_[1]].head;
    const glm::dvec3& spacing = scene_.volume.grid.spacing;
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
    const JointSurface surface = surface_at(normal, shorter);
    std::vector<std::uint8_t> side = cut_along(surface, 1);
    // If the two bones are fused, only the shape of the joint shows where one bone ends and the other begins.
    const double section = std::numbers::pi * surface.radius * surface.radius;
    if (surface.shape.sharp > 1 && area_of(side) > kClosed * section) side = cut_along(surface, surface.shape.sharp);
    part(side);
  }

  // Returns the radius of the bones at a joint, mm: the radius of a circle with the same area as the bone tissue in a
  // slice perpendicular to `axis`.
  //   half  half the thickness of the slice, mm
  double radius_at(const glm::dvec3& joint, const glm::dvec3& axis, double half) const {
    const glm::dvec3& spacing = scene_.volume.grid.spacing;
    const auto voxels = std::count_if(domain_.begin(), domain_.end(), [&](const Voxel& v) {
      return std::abs(glm::dot(world(v.at) - joint, axis)) < half;
    });
    return std::sqrt(double(voxels) * spacing.x * spacing.y * spacing.z / (2 * half) / std::numbers::pi);
  }
  JointSurface surface_at(const glm::dvec3& normal, double shorter) const {
    const Bone& bone = bones_[bone_[1]];
    const std::optional<JointShape>& shape = scene_.shape[bone_[1]];
    if (!shape) return flat_surface(bone.head, normal);
    const glm::dvec3& spacing = scene_.volume.grid.spacing;
    const glm::dvec3 axis = glm::normalize(glm::mix(normal, glm::normalize(bone.tail - bone.head), shape->turn));
    std::vector<glm::dvec3> places;
    for (const Voxel& v : domain_) places.push_back(world(v.at));
    const double half = std::max({spacing.x, spacing.y, spacing.z, kJointSlice * shorter});
    const double reach = std::max(0.5 * shorter, kJointReach * length_of(bones_[bone.parent]));
    return surface_of_joint(*shape, bone.head, axis, places, spacing.x * spacing.y * spacing.z, half, reach,
                            std::min({spacing.x, spacing.y, spacing.z}));
  }

  // Returns the normal, towards the child, of the plane that bisects the angle between parent and child. If the child's
  // head is not on the parent, returns the child's own direction.
  static glm::dvec3 normal_of_joint(const Bone& parent, const Bone& child) {
    const glm::dvec3 along = glm::normalize(child.tail - child.head),
                     of_parent = glm::normalize(parent.tail - parent.head);
    const glm::dvec3 on_parent = parent.head + along_bone(parent, child.head) * of_parent;
    if (glm::distance(on_parent, child.head) >= 0.1 * std::min(length_of(parent), length_of(child))) return along;
    const bool at_tail = glm::distance(child.head, parent.tail) <= glm::distance(child.head, parent.head);
    const glm::dvec3 halving = along + (at_tail ? of_parent : -of_parent);
    return glm::length(halving) > 0.3 ? glm::normalize(halving) : along;
  }

  void add(std::int32_t i) {
    const int nearest = scene_.near[i].bone[0];
    const std::vector<int>& allowed = scene_.candidates[scene_.group[i]];
    domain_.push_back({i, nearest == bone_[1],
                       allowed.empty() || std::find(allowed.begin(), allowed.end(), nearest) != allowed.end(), -1});
  }
  // Stores the connections between voxels of the domain in neighbour_.
  void link() {
    // For each of the two bones and each voxel to which it is the nearest bone: the voxel's index in the domain (the
    // voxels among which the cut is computed); -1: not in the domain.
    std::array<std::vector<std::int32_t>, 2> place;
    for (int which = 0; which < 2; ++which) place[which].assign(scene_.along[bone_[which]].size(), -1);
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i)
      place[domain_[i].nearest][scene_.near[domain_[i].at].rank] = i;
    neighbour_.resize(domain_.size());
    for (std::size_t i = 0; i < domain_.size(); ++i)
      for (int k = 0; k < 26; ++k) {
        const std::int32_t n = scene_.graph.neighbour[domain_[i].at][k];
        const int nearest = n >= 0 ? scene_.near[n].bone[0] : -1;
        const bool is_known = nearest >= 0 && (nearest == bone_[0] || nearest == bone_[1]);
        neighbour_[i][k] = is_known ? place[nearest == bone_[1]][scene_.near[n].rank] : -1;
      }
  }

  // Records the voxels that are connected with the shaft of one bone: they do not belong to the other bone.
  void tell_sides() {
    for (int which = 0; which < 2; ++which)
      for (const std::int32_t i : reached_from(which))
        found_.beyond.push_back({domain_[i].at, bone_[1 - which], bone_[which]});
  }

  // Marks the shaft of one of the two bones: in each of several slices across the bone, the tissue nearest to the bone.
  // Slices less than `beginning` mm from the joint are left out.
  void find_shaft(int which, const glm::dvec3& joint, double beginning, double width) {
    constexpr int kSlices = 16;
    const Bone& bone = bones_[bone_[which]];
    const double length = length_of(bone), at_joint = along_bone(bone, joint);
    std::array<float, kSlices + 1> nearest;
    nearest.fill(std::numeric_limits<float>::max());
    auto slice_of = [&](const Voxel& voxel) {
      if (voxel.nearest != which || !voxel.is_allowed) return -1;
      const double along = along_bone(bone, world(voxel.at));
      return std::abs(along - at_joint) >= beginning ? static_cast<int>(along / length * kSlices) : -1;
    };
    for (const Voxel& voxel : domain_)
      if (const int s = slice_of(voxel); s >= 0) nearest[s] = std::min(nearest[s], scene_.near[voxel.at].distance[0]);
    for (Voxel& voxel : domain_)
      if (const int s = slice_of(voxel);
          s >= 0 && scene_.near[voxel.at].distance[0] <= nearest[s] + width && nearest[s] < kFarAside * length)
        voxel.shaft = which;
  }

  // Returns the volume of the bone tissue that is nearest to one of the two rig bones and at least `beginning` mm away
  // from the joint, mm^3.
  double volume_along(int which, const glm::dvec3& joint, double beginning) const {
    const Bone& bone = bones_[bone_[which]];
    const double at_joint = along_bone(bone, joint);
    const auto voxels = std::count_if(domain_.begin(), domain_.end(), [&](const Voxel& v) {
      return v.nearest == which && std::abs(along_bone(bone, world(v.at)) - at_joint) >= beginning;
    });
    const glm::dvec3& spacing = scene_.volume.grid.spacing;
    return double(voxels) * spacing.x * spacing.y * spacing.z;
  }

  // Returns the voxels of the domain that are connected with the shaft of one of the two bones.
  std::vector<std::int32_t> reached_from(int which) const {
    std::vector<std::int32_t> front;
    std::vector<std::uint8_t> seen(domain_.size(), 0);
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i)
      if (domain_[i].shaft == which) front.push_back(i), seen[i] = 1;
    for (std::size_t k = 0; k < front.size(); ++k)
      for (const std::int32_t m : neighbour_[front[k]])
        if (m >= 0 && !seen[m]) seen[m] = 1, front.push_back(m);
    return front;
  }
  bool is_connected() const {
    const std::vector<std::int32_t> reached = reached_from(0);
    return std::any_of(reached.begin(), reached.end(), [&](std::int32_t i) { return domain_[i].shaft == 1; });
  }

  // Returns the factor on the area of a cut, as a function of the distance from the expected cut.
  //   off  this distance, as a share of the distance at which the shafts begin
  static double weight_away(double off) { return 1 + kAway * off * off; }

  // Returns the cut with the smallest weighted area: for each voxel of the domain 1 on the first bone's side, else 0.
  // Empty if no tissue connects the two shafts.
  //   weight  returns the factor on the area for (voxel, world point)
  std::vector<std::uint8_t> least_cut(const auto& weight) const {
    if (!is_connected()) return {};
    CutGraph<26> cut{neighbour_, std::vector<std::array<std::int32_t, 26>>(domain_.size()),
                     std::vector<std::int32_t>(domain_.size())};
    for (std::int32_t i = 0; i < std::ssize(domain_); ++i) {
      cut.terminal[i] = domain_[i].shaft == 0 ? kHard : domain_[i].shaft == 1 ? -kHard : 0;
      const std::int32_t here = domain_[i].at;
      for (int k = 0; k < 26; ++k) {
        const std::int32_t m = neighbour_[i][k];
        if (m < i) continue;
        const std::int32_t there = domain_[m].at;
        const double times = weight(here, (world(here) + world(there)) / 2.0);
        double cost = scene_.area[k] * times * (scene_.depth[here] + scene_.depth[there]) / 2;
        if (scene_.is_marrow(here) && scene_.is_marrow(there)) cost *= kMarrow;
        cut.capacity[i][k] = cut.capacity[m][25 - k] =
            static_cast<std::int32_t>(std::clamp(1000 * cost, 1.0, double(kHard)));
      }
    }
    return min_cut(std::move(cut));
  }
  // Returns the area of contact between the two sides of a cut, mm^2.
  double area_of(const std::vector<std::uint8_t>& side) const {
    double area = 0;
    for (std::int32_t i = 0; i < std::ssize(side); ++i)
      for (int k = 0; k < 26; ++k)
        if (const std::int32_t m = neighbour_[i][k]; m >= 0 && side[m] != side[i])
          area += scene_.area[k] / 2;  // half of the area, because each pair of voxels is visited from both voxels
    return area;
  }
  void part(const std::vector<std::uint8_t>& side) {
    cut_area_ = area_of(side);
    for (std::int32_t i = 0; i < std::ssize(side); ++i) {
      bool is_cut = false;
      for (int k = 0; k < 26; ++k) {
        std::int32_t& m = neighbour_[i][k];
        if (m < 0 || side[m] == side[i]) continue;
        m = -1;
        scene_.graph.neighbour[domain_[i].at][k] = kNotBone;
        is_cut = true;
      }
      if (is_cut) found_.at_cuts.push_back(domain_[i].at);
    }
  }
  glm::dvec3 world(std::int32_t i) const { return scene_.world(i); }
  Scene& scene_;
  const std::vector<Bone>& bones_;
  const std::array<int, 2> bone_;
  std::vector<Voxel> domain_;
  // For each voxel of the domain, its neighbours as indices in the domain; -1: none.
  std::vector<std::array<std::int32_t, 26>> neighbour_;
  double cut_area_ = 0;  // area of the cut that was made, mm^2
  Found found_;
};

// Makes all cuts between rig bones, several of them in parallel.
class JointCutter {
 public:
  explicit JointCutter(Scene scene) : scene_(std::move(scene)) {
    std::vector<std::string> names;
    std::vector<int> parents;
    for (const Bone& bone : scene_.bones) names.push_back(bone.name), parents.push_back(bone.parent);
    const std::vector<std::optional<JointRole>> roles = joint_roles(names, parents);
    for (const std::optional<JointRole>& role : roles) {
      scene_.is_ball.push_back(role && (role->part == BodyPart::Thigh || role->part == BodyPart::UpperArm));
      scene_.shape.push_back(shape_of_joint(role));
    }
    // bone_depth() uses one thread only, so another thread finds the nearest bones meanwhile.
    parallel_for(2, 1, [&](std::int64_t begin, std::int64_t end) {
      if (begin == 0) scene_.depth = bone_depth(scene_.graph, scene_.volume.grid.spacing);
      if (end == 2) find_nearest();
    });
  }

  // Cuts each bone from its parent. A bone whose head is nearer to another child of its parent, such as a thumb that
  // the rig attaches to the forearm beside the hand, is also cut from that child. The cuts run in waves: cuts of one
  // wave share no bone, and cuts that share a bone keep the order of the rig.
  void cut_joints(Progress& progress) {
    std::vector<std::array<int, 2>> joints;
    for (int child = 0; child < std::ssize(scene_.bones); ++child) {
      if (scene_.bones[child].parent < 0) continue;
      joints.push_back({scene_.bones[child].parent, child});
      if (const int other = bone_it_sits_on(child); other >= 0) joints.push_back({other, child});
    }
    std::vector<std::vector<std::size_t>> waves;
    std::vector<std::size_t> next_wave(scene_.bones.size(), 0);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const auto [parent, child] = joints[k];
      const std::size_t wave = std::max(next_wave[parent], next_wave[child]);
      if (wave >= waves.size()) waves.resize(wave + 1);
      waves[wave].push_back(k);
      next_wave[parent] = next_wave[child] = wave + 1;
    }
    std::vector<Found> found(joints.size());
    for (const std::vector<std::size_t>& wave : waves) {
      progress.update("bones", 0.4);
      parallel_for(std::ssize(wave), 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t k = begin; k < end; ++k)
          found[wave[k]] = Cut(scene_, joints[wave[k]][0], joints[wave[k]][1]).at_joint();
      });
    }
    keep(found);
  }

  // Cuts between bones that have no common joint but are side by side, such as fingers that are pressed together.
  void cut_sides() {
    std::map<std::array<int, 2>, std::vector<std::int32_t>> between;
    for (std::int32_t i = 0; i < scene_.graph.size(); ++i) {
      const Near& near = scene_.near[i];
      const auto [a, b] = std::minmax(near.bone[0], near.bone[1]);
      if (b < 0 || a < 0 || scene_.bones[a].parent == b || scene_.bones[b].parent == a) continue;
      if (near.distance[0] + near.distance[1] <=
          kSide * std::min(length_of(scene_.bones[a]), length_of(scene_.bones[b])))
        between[{a, b}].push_back(i);
    }
    const std::vector<std::pair<std::array<int, 2>, std::vector<std::int32_t>>> sides(between.begin(), between.end());
    std::vector<Found> found(sides.size());
    parallel_for(std::ssize(sides), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t k = begin; k < end; ++k)
        found[k] = Cut(scene_, sides[k].first[0], sides[k].first[1]).side_by_side(sides[k].second);
    });
    keep(found);
  }

  JointCuts cuts() && {
    lower_depth(scene_.graph, scene_.volume.grid.spacing, at_cuts_, scene_.depth);
    return {std::move(beyond_), std::move(broad_), std::move(scene_.depth)};
  }

 private:
  int bone_it_sits_on(int child) const {
    const glm::dvec3& joint = scene_.bones[child].head;
    int found = -1;
    double nearest = distance_to_bone(scene_.bones[scene_.bones[child].parent], joint);
    for (int b = 0; b < std::ssize(scene_.bones); ++b) {
      if (b == child || scene_.bones[b].parent != scene_.bones[child].parent) continue;
      if (along_bone(scene_.bones[b], joint) < kSitsAlong * length_of(scene_.bones[b])) continue;
      if (const double d = distance_to_bone(scene_.bones[b], joint); d < nearest) nearest = d, found = b;
    }
    return found;
  }

  void find_nearest() {
    // Bones that meet share an end point. So they are shortened for this search; near a joint, their directions then
    // decide which bone is nearer.
    std::vector<Bone> inner = scene_.bones;
    for (Bone& bone : inner)
      bone.head = glm::mix(bone.head, bone.tail, 0.1), bone.tail = glm::mix(bone.head, bone.tail, 8.0 / 9);
    scene_.near.resize(scene_.graph.size());
    parallel_for(scene_.graph.size(), 4096, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) {
        const glm::dvec3 at = scene_.world(static_cast<std::int32_t>(i));
        for (int b = 0; b < std::ssize(inner); ++b)
          scene_.near[i].take(b, static_cast<float>(distance_to_bone(inner[b], at)));
      }
    });
    scene_.along.resize(scene_.bones.size());
    for (std::int32_t i = 0; i < scene_.graph.size(); ++i) {
      Near& near = scene_.near[i];
      if (near.bone[0] < 0) continue;  // the distances to the rig bones are not finite
      near.rank = static_cast<std::int32_t>(scene_.along[near.bone[0]].size());
      scene_.along[near.bone[0]].push_back(i);
    }
  }
  void keep(const std::vector<Found>& found) {
    for (const Found& one : found) {
      beyond_.insert(beyond_.end(), one.beyond.begin(), one.beyond.end());
      at_cuts_.insert(at_cuts_.end(), one.at_cuts.begin(), one.at_cuts.end());
      if (one.broad) broad_.push_back(*one.broad);
    }
  }

  Scene scene_;
  std::vector<BeyondJoint> beyond_;
  std::vector<BroadCut> broad_;
  std::vector<std::int32_t> at_cuts_;  // voxels that lost connections by any of the cuts
};
}  // namespace

JointCuts cut_at_joints(BoneGraph& graph, const LabelVolume& volume, const std::vector<TissueKind>& kinds,
                        const Armature& armature, const std::vector<std::int32_t>& group,
                        const std::vector<std::vector<int>>& candidates, Progress& progress) {
  JointCutter cutter({graph,
                      volume,
                      kinds,
                      armature.bones,
                      group,
                      candidates,
                      world_from_voxel(volume.grid),
                      areas_of_edges(volume.grid.spacing),
                      {},
                      {},
                      {},
                      {},
                      {}});
  cutter.cut_joints(progress);
  cutter.cut_sides();
  return std::move(cutter).cuts();
}
}  // namespace limber
