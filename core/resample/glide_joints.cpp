// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/glide_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/parallel.h"
#include "core/bones/least_shift.h"

namespace limber {

namespace {

// Largest rotation per step, radians. In so small a step two bones approach each other by at most a voxel or two.
constexpr double kStep = 10 * std::numbers::pi / 180;
constexpr int kMargin = 2;  // width of the border around a bone in its distance field, voxels

struct Box {
  glm::dvec3 low{1e300}, high{-1e300};

  void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  bool empty() const { return !glm::all(glm::lessThanEqual(low, high)); }  // also true if a coordinate is NaN
  bool contains(const glm::dvec3& p) const {
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
  }
  Box grown(double by) const { return {low - by, high + by}; }
};

AffineTransform back(const AffineTransform& rigid) {
  const glm::dmat3 linear = glm::transpose(rigid.linear);
  return {linear, -(linear * rigid.offset)};
}

// The bone tissue that belongs to one rig bone.
struct BoneTissue {
  std::vector<glm::ivec3> voxels;
  Box box;  // box around the centres of the voxels, mm along the grid's axes
};

// Returns the bone tissue of every rig bone.
std::vector<BoneTissue> gather(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                               const SkinWeights& weights, const Armature& armature) {
  std::vector<int> bone_of;
  for (const std::string& name : weights.bones()) bone_of.push_back(require_bone(armature, name));
  constexpr std::int64_t kGrain = 256;
  struct Found {
    int bone;
    glm::ivec3 voxel;
  };
  std::vector<std::vector<Found>> found((weights.chunk_count() + kGrain - 1) / kGrain);
  parallel_for(weights.chunk_count(), kGrain, [&](std::int64_t begin, std::int64_t end) {
    auto& mine = found[begin / kGrain];
    for (std::int64_t brick = begin; brick < end; ++brick) {
      const auto& chunk = weights.chunk(brick);
      const std::int64_t first = tissue.bricks()[brick].first;
      tissue.for_each_of(brick, volume, is_bone, [&](std::int64_t place, const glm::ivec3& v) {
        mine.push_back({bone_of[chunk[place - first].bone[0]], v});
      });
    }
  });
  std::vector<BoneTissue> bones(armature.bones.size());
  for (const auto& block : found)
    for (const auto& [bone, voxel] : block) {
      bones[bone].voxels.push_back(voxel);
      bones[bone].box.add(glm::dvec3(voxel) * volume.grid.spacing);
    }
  return bones;
}

double angle_of(const glm::dquat& turn) {
  return 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
}

// A joint of the rig that the pose bends.
struct Joint {
  int bone, against;                 // the rig bone that may be shifted; its nearest ancestor with bone tissue
  std::vector<RigidTransform> path;  // motion of `bone` relative to `against` after each step; the last: in the pose
  double most_mm;                    // upper limit on the length of the shift, mm
  int below = 0;                     // number of bent joints above this one in the rig's hierarchy
};

class BentJoints {
 public:
  BentJoints(const Armature& armature, const Pose& pose, const std::vector<BoneTissue>& tissue,
             const GlideSettings& settings)
      : armature_(armature),
        pose_(pose) {
    for (int bone = 0; bone < std::ssize(armature.bones); ++bone) {
      const int against = above_with_tissue(bone, tissue);
      if (tissue[bone].voxels.empty() || against < 0) continue;
      if (auto path = path_of(bone, against); !path.empty())
        add({bone, against, std::move(path), settings.most_mm.value_or(settings.most_share * shorter(bone, against))});
    }
  }

  std::vector<Joint> joints;

 private:
  void add(Joint joint) {
    for (const Joint& other : joints)
      for (int b = joint.against; b >= 0; b = armature_.bones[b].parent)
        if (b == other.bone) joint.below = std::max(joint.below, other.below + 1);
    joints.push_back(std::move(joint));
  }

  int above_with_tissue(int bone, const std::vector<BoneTissue>& tissue) const {
    do bone = armature_.bones[bone].parent;
    while (bone >= 0 && tissue[bone].voxels.empty());
    return bone;
  }

  double shorter(int bone, int against) const {
    const auto length = [&](int b) { return glm::distance(armature_.bones[b].head, armature_.bones[b].tail); };
    return std::min(length(bone), length(against));
  }

  // Returns the motion of `bone` relative to `against` after each step from rest to the pose; empty: no joint between
  // the two bones turns.
  std::vector<RigidTransform> path_of(int bone, int against) const {
    double angle = 0;
    for (int b = bone; b != against; b = armature_.bones[b].parent) angle += angle_of(pose_.rotation[b]);
    const int steps = static_cast<int>(std::ceil(angle / kStep));
    std::vector<RigidTransform> path(steps);
    for (int step = 1; step <= steps; ++step)
      for (int b = bone; b != against; b = armature_.bones[b].parent)
        path[step - 1] = rotation_about(armature_.bones[b].head,
                                        glm::slerp(glm::dquat(1, 0, 0, 0), pose_.rotation[b], double(step) / steps)) *
                         path[step - 1];
    return path;
  }

  const Armature& armature_;
  const Pose& pose_;
};

// Returns a box around the rest positions of some voxels of a bone: those that at least one motion moves into `box`.
Box taken_into(const Box& box, const BoneTissue& bone, const std::vector<AffineTransform>& motions,
               const glm::dvec3& spacing) {
  Box from;  // box around all positions that a motion moves into `box`; excludes most voxels cheaply
  for (const AffineTransform& motion : motions) {
    const AffineTransform before = back(motion);
    for (int corner = 0; corner < 8; ++corner)
      from.add(before * glm::dvec3((corner & 1 ? box.high : box.low).x, (corner & 2 ? box.high : box.low).y,
                                   (corner & 4 ? box.high : box.low).z));
  }
  from = from.grown(glm::length(spacing) / 100);  // a margin for rounding errors
  Box around;
  for (const glm::ivec3& v : bone.voxels) {
    const glm::dvec3 place = glm::dvec3(v) * spacing;
    if (!from.contains(place) || around.contains(place)) continue;
    const auto arrives = [&](const AffineTransform& motion) { return box.contains(motion * place); };
    if (std::any_of(motions.begin(), motions.end(), arrives)) around.add(place);
  }
  return around;
}

VoxelBox voxels_around(const Box& box, const glm::dvec3& spacing) {
  if (box.empty()) return {};
  const glm::ivec3 low(glm::round(box.low / spacing)), high(glm::round(box.high / spacing));
  return {low - kMargin, high - low + 1 + 2 * kMargin};
}

// Returns the shortest shift of joint.bone that separates it from joint.against. Its components are along the grid's
// axes, in the frame in which joint.against is at rest.
LeastShift shift_of(const Joint& joint, const std::vector<BoneTissue>& tissue, const Grid& grid,
                    const ShiftBound& bound) {
  const glm::dmat3 to_grid = glm::inverse(grid.direction);
  std::vector<AffineTransform> path;
  for (const RigidTransform& motion : joint.path) {
    const glm::dmat3 turn = glm::mat3_cast(motion.rotation);
    path.push_back(
        {to_grid * turn * grid.direction, to_grid * (turn * grid.origin + motion.translation - grid.origin)});
  }
  const BoneTissue &fixed = tissue[joint.against], &turning = tissue[joint.bone];
  std::vector<AffineTransform> way_back;
  for (const AffineTransform& motion : path) way_back.push_back(back(motion));
  // Boxes around the voxels of each bone that the other bone can reach. Each box is computed from the previous one and
  // is smaller.
  const double reach = bound.most_mm + glm::length(grid.spacing);
  const Box first = taken_into(turning.box.grown(reach), fixed, way_back, grid.spacing);
  const Box near_turning = taken_into(first.grown(reach), turning, path, grid.spacing);
  const Box near_fixed = taken_into(near_turning.grown(reach), fixed, way_back, grid.spacing);
  const VoxelBox of_fixed = voxels_around(near_fixed, grid.spacing),
                 of_turning = voxels_around(near_turning, grid.spacing);
  if (of_fixed.size.x == 0 || of_turning.size.x == 0) return {};
  const BoneDistance from_fixed(grid.spacing, fixed.voxels, of_fixed),
      from_turning(grid.spacing, turning.voxels, of_turning);
  return least_shift({from_fixed, from_turning, grid.spacing}, path, bound);
}

// Returns, for each bone, the shift that its tissue gets: the sum of its own shift and the shifts of its ancestors.
std::vector<glm::dvec3> carried_by(std::vector<glm::dvec3> shifts, const Armature& armature) {
  for (std::size_t b = 0; b < shifts.size(); ++b)
    if (const int parent = armature.bones[b].parent; parent >= 0) shifts[b] += shifts[parent];
  return shifts;
}

// Returns the shift of a joint; none: the joint's two bones do not overlap.
//   motions  posed-from-rest motion of each bone
//   carried  #bones: sum of the bone's own shift and its ancestors' shifts; must be final for the bones above the joint
std::optional<GlidedJoint> glide_joint(const Joint& joint, const Armature& armature,
                                       const std::vector<BoneTissue>& tissue, const Grid& grid,
                                       const std::vector<RigidTransform>& motions,
                                       const std::vector<glm::dvec3>& carried, const GlideSettings& settings) {
  const glm::dmat3 posed_from_grid = glm::mat3_cast(motions[joint.against].rotation) * grid.direction;
  ShiftBound bound{.most_mm = joint.most_mm};
  if (settings.whole_mm) {
    bound.whole_mm = *settings.whole_mm;
    bound.carried = glm::inverse(posed_from_grid) * carried[joint.against];
    bound.most_mm = std::min(bound.most_mm, bound.whole_mm + glm::length(bound.carried));
  }
  const LeastShift found = shift_of(joint, tissue, grid, bound);
  if (found.free && found.shift == glm::dvec3(0)) return std::nullopt;
  return GlidedJoint{armature.bones[joint.bone].name,
                     armature.bones[joint.against].name,
                     posed_from_grid * found.shift,
                     bound.most_mm,
                     found.free,
                     found.depth_before,
                     found.depth_after};
}

}  // namespace

GlidedPose glide_joints(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                        const SkinWeights& weights, const Armature& armature, const Pose& pose,
                        const GlideSettings& settings, Progress& progress) {
  GlidedPose glided{pose, {}};
  glided.pose.shift.clear();
  const bool turns = std::any_of(pose.rotation.begin(), pose.rotation.end(),
                                 [](const glm::dquat& turn) { return turn != glm::dquat(1, 0, 0, 0); });
  if (!turns) return glided;
  progress.update("glide", 0);
  const std::vector<BoneTissue> bones = gather(volume, tissue, is_bone, weights, armature);
  const std::vector<Joint> joints = BentJoints(armature, pose, bones, settings).joints;
  const std::vector<RigidTransform> motions = posed_from_rest(armature, glided.pose);
  // #bones: the shift of each bone, mm, along the world axes.
  std::vector<glm::dvec3> shifts(armature.bones.size(), glm::dvec3(0));
  std::vector<std::optional<GlidedJoint>> found(joints.size());
  bool any = true;
  for (int below = 0; std::exchange(any, false); ++below) {
    const std::vector<glm::dvec3> carried = carried_by(shifts, armature);
    parallel_for(std::ssize(joints), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t j = begin; j < end; ++j)
        if (joints[j].below == below)
          found[j] = glide_joint(joints[j], armature, bones, volume.grid, motions, carried, settings);
    });
    for (std::size_t j = 0; j < joints.size(); ++j) {
      any |= joints[j].below > below;
      if (joints[j].below == below && found[j]) shifts[joints[j].bone] = found[j]->shift;
    }
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!found[j]) continue;
    glided.joints.push_back(*found[j]);
    if (found[j]->shift == glm::dvec3(0)) continue;
    const int bone = joints[j].bone;
    glided.pose.shift.resize(armature.bones.size(), glm::dvec3(0));
    glided.pose.shift[bone] = glm::conjugate(motions[armature.bones[bone].parent].rotation) * found[j]->shift;
  }
  progress.update("glide", 1);
  return glided;
}

}  // namespace limber
