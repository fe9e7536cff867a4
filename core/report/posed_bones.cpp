// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/posed_bones.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/base/parallel.h"
#include "core/bones/named_bones.h"

namespace limber {

namespace {
constexpr std::size_t kFewest = 30;  // a limb of which fewer voxels are found gets no measured direction
// Begin and end of a bone's shaft (its middle, away from the joints), as fractions of the rig bone's length.
constexpr double kShaftBegin = 0.25, kShaftEnd = 0.75;
constexpr double kShaftRadius = 0.15;  // radius of the shaft, as a fraction of the rig bone's length
constexpr double kManyAtShaft = 0.2;   // least fraction of a shaft's voxels that keep_limb() takes as the limb

struct Moved {
  glm::dvec3 rest, posed;  // rest and posed position of a voxel, world, mm
};
using MovedVoxels = std::vector<Moved>;

struct BoneVoxel {
  std::int32_t at_rest;  // index in the bone graph of the voxel at rest; -1: no graph
  Moved moved;
};

// The graph of bone voxels of the rest volume, and the index of each tissue voxel in it. The graph is costly, so it is
// built only if labels name bones.
struct RestBone {
  TissueVoxels tissue;
  BoneGraph graph;
  std::vector<std::int32_t> in_graph;  // #tissue: index in the graph; -1: the voxel is not bone

  RestBone(const LabelVolume& rest, const std::vector<TissueKind>& kinds)
      : tissue(rest),
        graph(gather_bone(rest, tissue, kinds)),
        in_graph(static_cast<std::size_t>(tissue.size()), -1) {
    for (std::int32_t i = 0; i < graph.size(); ++i) in_graph[graph.place[i]] = i;
  }
};

// Returns the posed bone voxels, in the order of the posed grid. Leaves out voxels whose label differs from the label
// at their rest position.
//   bone  nullptr: the voxels get no index in the bone graph
std::vector<BoneVoxel> posed_bone_voxels(const JudgedPose& pose, const RestBone* bone,
                                         const std::vector<TissueKind>& kinds) {
  const AffineTransform to_rest = voxel_from_world(pose.rest.grid);
  const glm::ivec3 size = pose.posed.grid.size;
  std::vector<std::vector<BoneVoxel>> slices(size.z);
  parallel_for(size.z, 1, [&](std::int64_t z, std::int64_t) {
    std::int64_t at = pose.posed.grid.index({0, 0, int(z)});
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x, ++at) {
        const Label label = pose.posed.voxels[at];
        if (label == 0 || !is_bone(kinds[label])) continue;
        const Moved moved{pose.rest_place({x, y, z}), pose.posed_place({x, y, z})};
        const glm::ivec3 rest(glm::floor(to_rest * moved.rest + 0.5));
        if (pose.rest.at_or_air(rest) == label)
          slices[z].push_back({bone ? bone->in_graph[bone->tissue.index_of(rest)] : -1, moved});
      }
  });
  std::vector<BoneVoxel> all;
  for (auto& slice : slices) {
    all.insert(all.end(), slice.begin(), slice.end());
    slice = {};
  }
  return all;
}

double largest_residual(const MovedVoxels& voxels, const RigidTransform& motion) {
  double worst = 0;
  for (const Moved& one : voxels) worst = std::max(worst, glm::distance(motion * one.rest, one.posed));
  return worst;
}

RigidTransform best_motion(const MovedVoxels& voxels) {
  std::vector<glm::dvec3> rest, posed;
  for (const Moved& one : voxels) rest.push_back(one.rest), posed.push_back(one.posed);
  return best_rigid_motion(rest, posed);
}

// Returns the allowed rig bone whose motion brings the largest number of voxels to their posed positions.
//   within  largest distance from the posed position, mm
int best_bone(const MovedVoxels& voxels, const std::vector<int>& allowed, const std::vector<RigidTransform>& motions,
              double within) {
  int best = allowed.front();
  std::int64_t most = -1;
  for (const int bone : allowed) {
    const std::int64_t right = std::count_if(voxels.begin(), voxels.end(), [&](const Moved& one) {
      return glm::distance(motions[bone] * one.rest, one.posed) <= within;
    });
    if (right > most) most = right, best = bone;
  }
  return best;
}

// Returns the rig bone that a voxel follows: the bone whose motion moves it nearest to its posed position.
std::size_t followed_bone(const Moved& one, const std::vector<RigidTransform>& motions) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < motions.size(); ++b)
    if (const double off = glm::distance(motions[b] * one.rest, one.posed); off < least - 1e-6) least = off, best = b;
  return best;
}
// Returns the rig bone that most of the voxels follow.
std::size_t followed_bone(const MovedVoxels& voxels, const std::vector<RigidTransform>& motions) {
  std::vector<std::int64_t> votes(motions.size(), 0);
  for (const Moved& one : voxels) ++votes[followed_bone(one, motions)];
  return static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

// Judges one bone of the body (the voxels of a label on one side of the body) by the motions of the rig bones that its
// name allows.
//   single  true: the label names one bone, which must move rigidly
//   within  largest distance, mm, of a voxel from where its rig bone moves it; at a larger distance the voxel is wrong
WholeBone judge(const MovedVoxels& voxels, const std::vector<int>& allowed, bool single, const JudgedPose& pose,
                double within) {
  WholeBone bone;
  const int own = best_bone(voxels, allowed, pose.applied, within);
  MovedVoxels wrong;
  for (const Moved& one : voxels) {
    const auto goes_with = [&](int b) { return glm::distance(pose.applied[b] * one.rest, one.posed) <= within; };
    if (!(single ? goes_with(own) : std::any_of(allowed.begin(), allowed.end(), goes_with))) wrong.push_back(one);
  }
  bone.belongs_to = pose.armature->bones[own].name;
  bone.voxels = std::ssize(voxels);
  bone.wrong_voxels = std::ssize(wrong);
  if (!wrong.empty()) bone.went_with = pose.armature->bones[followed_bone(wrong, pose.applied)].name;
  if (single) bone.residual_mm = largest_residual(voxels, best_motion(voxels));
  return bone;
}

// Returns true if a motion turns or shifts a bone. A bone may move without turning, such as a shank that hangs down
// from a raised thigh.
bool moves(const RigidTransform& motion) {
  return motion.rotation != glm::dquat(1, 0, 0, 0) || motion.translation != glm::dvec3(0);
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

LimbDirection direction_of(int bone, const MovedVoxels& voxels, bool by_name, const JudgedPose& pose) {
  const glm::dquat asked = pose.asked[bone].rotation, reached = best_motion(voxels).rotation;
  const glm::dvec3 along = pose.armature->bones[bone].tail - pose.armature->bones[bone].head;
  glm::dquat off = reached * glm::conjugate(asked);
  if (off.w < 0) off = -off;
  LimbDirection limb{.bone = pose.armature->bones[bone].name};
  limb.direction_degrees = degrees_between(asked * along, reached * along);
  limb.orientation_degrees = glm::degrees(2 * std::atan2(glm::length(glm::dvec3(off.x, off.y, off.z)), off.w));
  limb.voxels = std::ssize(voxels);
  limb.by_name = by_name;
  return limb;
}

// Returns true if a point is at a rig bone's shaft: close to the middle of the bone's axis, and nearer to this axis
// than to the axis of any other bone.
bool is_at_shaft(const Armature& armature, int bone, const glm::dvec3& p) {
  const Bone& own = armature.bones[bone];
  const glm::dvec3 axis = own.tail - own.head;
  const double length = glm::length(axis);
  if (!(length > 0)) return false;
  const double along = glm::dot(p - own.head, axis) / (length * length);
  if (along < kShaftBegin || along > kShaftEnd) return false;
  const double away = distance_to_bone(own, p);
  if (away > kShaftRadius * length) return false;
  return std::all_of(armature.bones.begin(), armature.bones.end(),
                     [&](const Bone& other) { return distance_to_bone(other, p) >= away; });
}

// Removes other bones' voxels, such as those of ribs below a collarbone, from the voxels at a limb's shaft. Keeps the
// voxels that follow the limb's rig bone if they are at least the fraction kManyAtShaft. Otherwise keeps the voxels
// that follow the most followed rig bone.
void keep_limb(int bone, const std::vector<RigidTransform>& motions, MovedVoxels& shaft) {
  const auto follows = [&](std::size_t b) {
    return [&motions, b](const Moved& one) { return followed_bone(one, motions) == b; };
  };
  const auto own = std::count_if(shaft.begin(), shaft.end(), follows(static_cast<std::size_t>(bone)));
  const bool are_many = double(own) >= kManyAtShaft * double(shaft.size());
  if (shaft.empty()) return;
  std::erase_if(shaft, std::not_fn(follows(are_many ? static_cast<std::size_t>(bone) : followed_bone(shaft, motions))));
}

std::vector<LimbDirection> limb_directions(const JudgedPose& pose, const std::vector<BoneVoxel>& bone,
                                           const std::vector<MovedVoxels>& named) {
  std::vector<LimbDirection> limbs;
  for (int b = 0; b < std::ssize(pose.armature->bones); ++b) {
    if (!moves(pose.asked[b])) continue;
    const bool by_name = named[b].size() >= kFewest;
    MovedVoxels shaft;
    if (!by_name)
      for (const BoneVoxel& one : bone)
        if (is_at_shaft(*pose.armature, b, one.moved.rest)) shaft.push_back(one.moved);
    keep_limb(b, pose.applied, shaft);
    const MovedVoxels& voxels = by_name ? named[b] : shaft;
    if (voxels.size() >= kFewest) limbs.push_back(direction_of(b, voxels, by_name, pose));
  }
  return limbs;
}

// Judges each bone that a label names, on each side of the body. If the label names a single bone, the bone's voxels
// are added to the entry of `of_rig_bone` for the rig bone that the bone belongs to.
std::vector<WholeBone> judge_named(const JudgedPose& pose, const std::map<Label, LabelBones>& labels,
                                   const RestBone& rest, const std::vector<BoneVoxel>& bone,
                                   std::vector<MovedVoxels>& of_rig_bone) {
  const NamedBones named = assign_named_bones(rest.graph, pose.rest, pose.tissues.kinds(), *pose.armature, labels);
  std::map<std::pair<Label, std::int32_t>, MovedVoxels> members;
  for (const BoneVoxel& one : bone)
    if (const Label label = pose.rest.at(rest.graph.voxel[one.at_rest]); labels.contains(label))
      members[{label, named.group[one.at_rest]}].push_back(one.moved);
  const glm::dvec3& spacing = pose.rest.grid.spacing;
  const double within = std::max({spacing.x, spacing.y, spacing.z});
  std::vector<WholeBone> all;
  for (const auto& [key, voxels] : members) {
    const auto& [label, group] = key;
    const bool single = labels.at(label).single;
    if (named.candidates[group].empty()) continue;
    WholeBone& whole = all.emplace_back(judge(voxels, named.candidates[group], single, pose, within));
    whole.label = label;
    whole.file_value = pose.tissues.find(label)->file_value;
    whole.name = pose.tissues.find(label)->name;
    if (!single) continue;
    MovedVoxels& of_bone = of_rig_bone[*pose.armature->find(whole.belongs_to)];
    of_bone.insert(of_bone.end(), voxels.begin(), voxels.end());
  }
  return all;
}
}  // namespace

PosedBoneMeasures measure_posed_bones(const JudgedPose& pose, const BoneMap& map) {
  const std::vector<TissueKind> kinds = pose.tissues.kinds();
  const std::map<Label, LabelBones> labels = bones_of_labels(pose.tissues, *pose.armature, map);
  std::optional<RestBone> rest;
  if (!labels.empty()) rest.emplace(pose.rest, kinds);
  const std::vector<BoneVoxel> bone = posed_bone_voxels(pose, rest ? &*rest : nullptr, kinds);
  std::vector<MovedVoxels> of_rig_bone(pose.armature->bones.size());
  PosedBoneMeasures found;
  if (rest) found.whole = judge_named(pose, labels, *rest, bone, of_rig_bone);
  rest.reset();
  found.limbs = limb_directions(pose, bone, of_rig_bone);
  return found;
}

}  // namespace limber
