// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/seam_pairs.h"

#include <algorithm>
#include <limits>
#include <map>

#include "core/binding/flesh_graph.h"
#include "core/rig/joint_names.h"
#include "core/seams/limbs.h"

namespace limber {

namespace {

constexpr double kEnd = 8;  // voxels; a face gets the bones of another face only if that face is at most this far away

const char* word_for(BodyPart part) {
  switch (part) {
    case BodyPart::Pelvis:
    case BodyPart::HipLink: return "hip";
    case BodyPart::Spine: return "trunk";
    case BodyPart::Neck: return "neck";
    case BodyPart::Head: return "head";
    case BodyPart::Clavicle: return "shoulder";
    case BodyPart::UpperArm: return "upper arm";
    case BodyPart::Forearm: return "forearm";
    case BodyPart::Hand:
    case BodyPart::Palm: return "hand";
    case BodyPart::Fingers: return "fingers";
    case BodyPart::Thumb: return "thumb";
    case BodyPart::Index: return "index finger";
    case BodyPart::Middle: return "middle finger";
    case BodyPart::Ring: return "ring finger";
    case BodyPart::Little: return "little finger";
    case BodyPart::Thigh: return "thigh";
    case BodyPart::Shank: return "shank";
    case BodyPart::Foot: return "foot";
    case BodyPart::Toes: return "toes";
  }
  return "";
}

std::string words_for(const JointRole& role) {
  // The first bone of a finger (index 0) lies in the palm.
  const bool in_palm = role.index == 0 && role.part >= BodyPart::Index && role.part <= BodyPart::Little;
  const std::string part = in_palm ? "hand" : word_for(role.part);
  return role.side == BodySide::Left ? "left " + part : role.side == BodySide::Right ? "right " + part : part;
}

struct Face {
  glm::dvec3 middle;
  int lower, upper;  // bones nearest to the two voxels of the face, -1: none
};

// Returns true if a seam can lie between the face's two bones: one bone belongs to a limb that may touch the other
// bone.
bool may_touch(const std::vector<Limb>& limbs, const Face& face) {
  if (face.lower < 0 || face.upper < 0) return false;
  return std::any_of(limbs.begin(), limbs.end(), [&](const Limb& limb) {
    return (limb.has_bone[face.lower] && limb.may_touch[face.upper]) ||
           (limb.has_bone[face.upper] && limb.may_touch[face.lower]);
  });
}

// Corrects the bones of faces at the ends of seams. There, the nearest bones of a face's two voxels may belong to one
// limb, between whose bones no seam can lie. Such a face gets the bones of the nearest face whose bones may touch, if
// that face is at most `reach` mm away.
void settle_ends(std::vector<Face>& faces, const std::vector<Limb>& limbs, double reach) {
  std::vector<Face> settled;
  for (const Face& face : faces)
    if (may_touch(limbs, face)) settled.push_back(face);
  for (Face& face : faces) {
    if (settled.empty() || may_touch(limbs, face)) continue;
    const Face& nearest = *std::min_element(settled.begin(), settled.end(), [&](const Face& a, const Face& b) {
      return glm::distance(a.middle, face.middle) < glm::distance(b.middle, face.middle);
    });
    if (glm::distance(nearest.middle, face.middle) <= reach) face.lower = nearest.lower, face.upper = nearest.upper;
  }
}

glm::dvec3 nearest_to_mean(const std::vector<glm::dvec3>& points) {
  glm::dvec3 mean(0);
  for (const glm::dvec3& point : points) mean += point / double(points.size());
  return *std::min_element(points.begin(), points.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::distance(a, mean) < glm::distance(b, mean);
  });
}

}  // namespace

std::vector<std::string> body_parts_of(const Armature& armature) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) names.push_back(bone.name), parents.push_back(bone.parent);
  const auto roles = joint_roles(names, parents);
  for (std::size_t b = 0; b < names.size(); ++b)
    if (roles[b]) names[b] = words_for(*roles[b]);
  return names;
}

std::vector<SeamPair> seam_pairs(const Seams& seams, const LabelVolume& volume, const TissueVoxels& tissue,
                                 const Armature& armature, const BoneParts& parts, Progress& progress) {
  progress.update("seams", 0);
  if (seams.empty()) return {};
  TissueVoxels parted = tissue;
  parted.set_seams(std::make_shared<const Seams>(seams));
  const NearestBone nearest = nearest_bone(volume, parted, armature, fixed_bone(volume, parted, parts, armature));
  if (progress.cancelled()) throw Cancelled();
  const std::vector<std::string> names = body_parts_of(armature);
  const AffineTransform world = world_from_voxel(volume.grid);
  std::vector<Face> all;
  seams.for_each([&](const glm::ivec3& lower, int axis) {
    glm::ivec3 upper = lower;
    ++upper[axis];
    const auto bone_of = [&](const glm::ivec3& v) {
      const std::int64_t place = parted.index_of(v);
      return place < 0 || nearest.bone[place] == kSoft ? -1 : int{nearest.bone[place]};
    };
    all.push_back({world * (0.5 * (glm::dvec3(lower) + glm::dvec3(upper))), bone_of(lower), bone_of(upper)});
  });
  const glm::dvec3 spacing = volume.grid.spacing;
  settle_ends(all, limbs_of(armature), kEnd * std::max({spacing.x, spacing.y, spacing.z}));
  std::map<std::pair<std::string, std::string>, std::vector<glm::dvec3>> faces;
  for (const Face& face : all) {
    const auto part_of = [&](int bone) { return bone < 0 ? std::string("no bone") : names[bone]; };
    const std::string one = part_of(face.lower), other = part_of(face.upper);
    const auto pair = std::minmax(one, other);
    faces[{pair.first, pair.second}].push_back(face.middle);
  }
  std::vector<SeamPair> pairs;
  for (const auto& [parts_of_pair, middles] : faces)
    pairs.push_back({parts_of_pair.first, parts_of_pair.second, std::ssize(middles), nearest_to_mean(middles)});
  std::stable_sort(pairs.begin(), pairs.end(), [](const SeamPair& a, const SeamPair& b) { return a.faces > b.faces; });
  progress.update("seams", 1);
  return pairs;
}

}  // namespace limber
