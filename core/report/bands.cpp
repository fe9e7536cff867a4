// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/bands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/parallel.h"
#include "core/report/voxel_pieces.h"

namespace limber {

namespace {
// Two neighbours in the posed volume count as neighbours at rest if their distance at rest is at most this many voxel
// edges of the posed grid.
constexpr double kNeighbours = 3;
// Weight of the distance from a bone at rest, mm, relative to the error of its motion, mm, in bone_that_carries().
constexpr double kShareOfDistance = 0.05;
constexpr int kArcSteps = 16;  // number of steps in which a joint's arc (its turn from rest to the pose) is sampled

struct Joint {
  int parent, bone;
  glm::dvec3 head;
  double reach;                                          // radius around the head within which tissue may stretch, mm
  std::array<RigidTransform, kArcSteps + 1> on_the_way;  // motions along the arc, from the parent's to the bone's
};

bool same_motion(const RigidTransform& a, const RigidTransform& b, const glm::dvec3& at) {
  return std::abs(glm::dot(a.rotation, b.rotation)) > 1 - 1e-12 && glm::distance(a * at, b * at) < 1e-6;
}

// Returns the distance in mm from a point to the nearest outside air, but at least one voxel edge.
double depth_at(const Grid& grid, const OutsideAir& outside, const glm::dvec3& p) {
  const glm::ivec3 middle(glm::floor(voxel_from_world(grid) * p + 0.5));
  const double edge = std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  if (outside.contains(middle)) return edge;
  // Searches larger and larger boxes around the point, until the nearest air in the box is nearer than the box's
  // border.
  for (double half = 8 * edge;; half *= 2) {
    const glm::ivec3 steps(glm::ceil(half / grid.spacing));
    double nearest = std::numeric_limits<double>::infinity();
    for (int z = -steps.z; z <= steps.z; ++z)
      for (int y = -steps.y; y <= steps.y; ++y)
        for (int x = -steps.x; x <= steps.x; ++x) {
          const glm::ivec3 v = middle + glm::ivec3(x, y, z);
          if (outside.contains(v)) nearest = std::min(nearest, glm::length(glm::dvec3(x, y, z) * grid.spacing));
        }
    if (nearest <= half) return std::max(nearest, edge);
  }
}

// Returns the joints that the pose turns.
std::vector<Joint> turned_joints(const JudgedPose& pose, const OutsideAir& outside, const BandLimits& limits) {
  std::vector<Joint> joints;
  for (int b = 0; b < std::ssize(pose.armature->bones); ++b) {
    const Bone& bone = pose.armature->bones[b];
    if (bone.parent < 0 || same_motion(pose.applied[b], pose.applied[bone.parent], bone.head)) continue;
    Joint& joint = joints.emplace_back(
        Joint{bone.parent, b, bone.head, limits.joint_reach * depth_at(pose.rest.grid, outside, bone.head), {}});
    const RigidTransform turn = inverse(pose.applied[bone.parent]) * pose.applied[b];
    const glm::dvec3 slid = turn * bone.head - bone.head;
    for (int k = 0; k <= kArcSteps; ++k) {
      const double share = double(k) / kArcSteps;
      const glm::dquat part = glm::slerp(glm::dquat(1, 0, 0, 0), turn.rotation, share);
      joint.on_the_way[k] =
          pose.applied[bone.parent] * RigidTransform{part, bone.head + share * slid - part * bone.head};
    }
  }
  return joints;
}

double distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = b - a;
  const double squared = glm::dot(d, d);
  return glm::distance(p, squared > 0 ? a + glm::clamp(glm::dot(p - a, d) / squared, 0.0, 1.0) * d : a);
}

// Returns true if the rotation of the joint explains where stretched tissue moved. The tissue must be near the joint at
// rest. Its posed position must be near the arc, or the straight chord, between the positions to which the joint's two
// bones would move the tissue.
bool explains(const Joint& joint, const glm::dvec3& rest, const glm::dvec3& posed, const BandLimits& limits) {
  if (glm::distance(rest, joint.head) > joint.reach) return false;
  const double within = limits.off_arc * joint.reach;
  glm::dvec3 before = joint.on_the_way[0] * rest;
  if (distance_to_segment(posed, before, joint.on_the_way[kArcSteps] * rest) <= within)
    return true;  // linear blend skinning may move tissue anywhere along the chord of the arc
  for (int k = 1; k <= kArcSteps; ++k) {
    const glm::dvec3 next = joint.on_the_way[k] * rest;
    if (distance_to_segment(posed, before, next) <= within) return true;
    before = next;
  }
  return false;
}

// The gradient of the map from posed to rest positions, in world axes. A voxel has no gradient if along one of the axes
// neither neighbour is soft tissue that was a neighbour at rest too.
class RestGradient {
 public:
  RestGradient(const JudgedPose& pose, std::vector<bool> is_soft) : pose_(pose), is_soft_(std::move(is_soft)) {}

  bool is_soft(const glm::ivec3& v) const { return pose_.posed.grid.contains(v) && is_soft_[pose_.posed.at(v)]; }

  std::optional<glm::dmat3> at(const glm::ivec3& v) const {
    const glm::dvec3 here = pose_.rest_place(v);
    glm::dmat3 per_step(0);
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 step(0);
      step[axis] = 1;
      const double far = kNeighbours * pose_.posed.grid.spacing[axis];
      int sides = 0;
      for (const int sign : {-1, 1}) {
        const glm::ivec3 beside = v + sign * step;
        if (!is_soft(beside)) continue;
        const glm::dvec3 difference = double(sign) * (pose_.rest_place(beside) - here);
        if (glm::length(difference) >= far) continue;
        per_step[axis] += difference;
        ++sides;
      }
      if (sides == 0) return std::nullopt;
      per_step[axis] /= pose_.posed.grid.spacing[axis] * sides;
    }
    return per_step * glm::transpose(pose_.posed.grid.direction);
  }

 private:
  const JudgedPose& pose_;
  std::vector<bool> is_soft_;  // by label: true for soft tissue
};

struct StretchedVoxels {
  std::vector<std::int64_t> at;
  std::vector<float> stretch;
};

StretchedVoxels unexplained(const JudgedPose& pose, const RestGradient& gradient, const std::vector<Joint>& joints,
                            const BandLimits& limits) {
  const glm::ivec3 size = pose.posed.grid.size;
  std::vector<StretchedVoxels> slices(size.z);
  parallel_for(size.z, 1, [&](std::int64_t z, std::int64_t) {
    std::int64_t at = pose.posed.grid.index({0, 0, int(z)});
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x, ++at) {
        const glm::ivec3 v(x, y, z);
        if (pose.posed.voxels[at] == 0 || !gradient.is_soft(v)) continue;
        const auto map = gradient.at(v);
        if (!map) continue;
        const double stretch = largest_stretch(*map);
        if (!(stretch > limits.stretch)) continue;
        const glm::dvec3 rest = pose.rest_place(v), posed = pose.posed_place(v);
        if (std::any_of(joints.begin(), joints.end(),
                        [&](const Joint& joint) { return explains(joint, rest, posed, limits); }))
          continue;
        slices[z].at.push_back(at);
        slices[z].stretch.push_back(static_cast<float>(std::min(stretch, 1e6)));
      }
  });
  StretchedVoxels all;
  for (const StretchedVoxels& slice : slices) {
    all.at.insert(all.at.end(), slice.at.begin(), slice.at.end());
    all.stretch.insert(all.stretch.end(), slice.stretch.begin(), slice.stretch.end());
  }
  return all;
}

// Returns the rig bone that most likely moved the tissue from its rest position to its posed position: the bone whose
// motion comes nearest to the posed position. Distance from the bone at rest counts too, because the blended motion of
// tissue may by chance resemble the motion of a bone far away.
int bone_that_carries(const JudgedPose& pose, const glm::dvec3& rest, const glm::dvec3& posed) {
  const auto& bones = pose.armature->bones;
  double least = std::numeric_limits<double>::infinity();
  int best = 0;
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const double off =
        glm::distance(pose.applied[b] * rest, posed) + kShareOfDistance * distance_to_bone(bones[b], rest);
    if (off < least) least = off, best = static_cast<int>(b);
  }
  return best;
}

// Returns the names of the two rig bones that a band joins. The first is the bone that most of the band's voxels
// follow. The second is, of the bones that move differently, the one that most voxels follow; empty: there is none.
std::array<std::string, 2> ends_of(const JudgedPose& pose, const std::vector<glm::ivec3>& voxels) {
  std::vector<std::int64_t> votes(pose.armature->bones.size(), 0);
  glm::dvec3 middle(0);
  for (const glm::ivec3& v : voxels) {
    const glm::dvec3 rest = pose.rest_place(v);
    middle += rest / double(voxels.size());
    ++votes[bone_that_carries(pose, rest, pose.posed_place(v))];
  }
  std::vector<int> order(votes.size());
  for (int b = 0; b < std::ssize(order); ++b) order[b] = b;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return votes[a] > votes[b]; });
  std::array<std::string, 2> between{pose.armature->bones[order[0]].name, ""};
  for (const int b : order)
    if (votes[b] > 0 && !same_motion(pose.applied[b], pose.applied[order[0]], middle)) {
      between[1] = pose.armature->bones[b].name;
      break;
    }
  return between;
}

Band describe(const JudgedPose& pose, const StretchedVoxels& voxels, const std::vector<std::int64_t>& piece) {
  Band band;
  band.voxels = std::ssize(piece);
  band.mm3 = double(band.voxels) * pose.posed.grid.voxel_volume();
  band.place = pose.posed_place(middle_voxel(pose.posed.grid, voxels.at, piece));
  std::vector<float> stretch;
  std::vector<glm::ivec3> places;
  for (const std::int64_t i : piece) {
    stretch.push_back(voxels.stretch[i]);
    places.push_back(voxel_of_index(pose.posed.grid, voxels.at[i]));
  }
  std::nth_element(stretch.begin(), stretch.begin() + std::ssize(stretch) / 2, stretch.end());
  band.stretch = stretch[stretch.size() / 2];
  band.between = ends_of(pose, places);
  return band;
}
}  // namespace

double largest_stretch(const glm::dmat3& rest_from_posed) {
  // Computes the smallest eigenvalue of G^T G, where G is the gradient, in closed form [Smith 1961].
  const glm::dmat3 m = glm::transpose(rest_from_posed) * rest_from_posed;
  const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  const double off = m[1][0] * m[1][0] + m[2][0] * m[2][0] + m[2][1] * m[2][1];
  const glm::dvec3 d(m[0][0] - mean, m[1][1] - mean, m[2][2] - mean);
  const double p = std::sqrt((glm::dot(d, d) + 2 * off) / 6);
  if (p <= 1e-12 * mean) return mean > 0 ? 1 / std::sqrt(mean) : std::numeric_limits<double>::infinity();
  const double r = std::clamp(glm::determinant((m - glm::dmat3(mean)) / p) / 2, -1.0, 1.0);
  const double least = mean + 2 * p * std::cos(std::acos(r) / 3 + 2 * M_PI / 3);
  return least > 0 ? 1 / std::sqrt(least) : std::numeric_limits<double>::infinity();
}

std::vector<Band> find_bands(const JudgedPose& pose, const AirAround& air, const BandLimits& limits) {
  std::vector<bool> is_soft(65536, true);
  is_soft[0] = false;
  for (const Tissue& tissue : pose.tissues.tissues)
    if (is_bone(tissue.kind)) is_soft[tissue.label] = false;
  const RestGradient gradient(pose, std::move(is_soft));
  const StretchedVoxels voxels = unexplained(pose, gradient, turned_joints(pose, air.rest, limits), limits);
  std::vector<Band> bands;
  for (const auto& piece : pieces_of(pose.posed.grid, voxels.at))
    if (std::ssize(piece) >= limits.least_voxels) bands.push_back(describe(pose, voxels, piece));
  return bands;
}

}  // namespace limber
