// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/same_skeleton.h"

#include <map>
#include <string>
#include <vector>

#include "core/motion/body_frame.h"

namespace limber {

namespace {

// The skeletons differ if a joint is further from its bone's head than this share of the rig's size.
constexpr double kAlike = 1e-3;
constexpr double kInPlace = 0.01;  // mm; smaller differences of size and position between motion and rig are ignored

// Returns the rest position of each bone's joint, in LPS axes, in the order of the bones. Returns nothing if a bone has
// no joint of the same name, or if their parents have different names.
std::optional<std::vector<glm::dvec3>> places_by_bone(const Motion& motion, const Armature& armature) {
  std::map<std::string, int> joints;
  for (std::size_t j = 0; j < motion.joints.size(); ++j) joints.emplace(motion.joints[j].name, static_cast<int>(j));
  const auto world = forward_kinematics(motion, -1);
  std::vector<glm::dvec3> places;
  for (const Bone& bone : armature.bones) {
    const auto joint = joints.find(bone.name);
    if (joint == joints.end()) return std::nullopt;
    const int parent = motion.joints[joint->second].parent;
    if ((parent < 0) != (bone.parent < 0) ||
        (parent >= 0 && motion.joints[parent].name != armature.bones[bone.parent].name))
      return std::nullopt;
    places.push_back(lps_from_bvh(world[joint->second].translation));
  }
  return places;
}

std::size_t farthest(const std::vector<glm::dvec3>& places, const auto& distance) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (distance(places[i]) > distance(places[best])) best = i;
  return best;
}

// Returns orthonormal axes from three of the positions; nothing if these are nearly in line. The third axis points from
// position a to position b; the first is as near as possible to the direction from a to c.
std::optional<glm::dmat3> axes_by(const std::vector<glm::dvec3>& places, std::size_t a, std::size_t b, std::size_t c) {
  return axes_of(places[b] - places[a], places[c] - places[a]);
}

}  // namespace

std::optional<SameSkeleton> same_skeleton(const Motion& motion, const Armature& armature) {
  if (armature.bones.size() < 2) return std::nullopt;
  const auto source = places_by_bone(motion, armature);
  if (!source) return std::nullopt;
  std::vector<glm::dvec3> rig;
  for (const Bone& bone : armature.bones) rig.push_back(bone.head);

  const std::size_t far = farthest(rig, [&](const glm::dvec3& p) { return glm::distance(p, rig[0]); });
  const glm::dvec3 along = rig[far] - rig[0], source_along = (*source)[far] - (*source)[0];
  const double size = glm::length(along), source_size = glm::length(source_along);
  if (size < 1e-9 || source_size < 1e-9) return std::nullopt;
  const std::size_t aside =
      farthest(rig, [&](const glm::dvec3& p) { return glm::length(glm::cross(p - rig[0], along)); });

  SameSkeleton same;
  same.scale = size / source_size;
  const auto alike = [&] {
    for (std::size_t b = 0; b < rig.size(); ++b)
      if (glm::distance(rig[b] - rig[0], same.scale * (same.rig_from_source * ((*source)[b] - (*source)[0]))) >
          kAlike * size)
        return false;
    return true;
  };
  if (alike()) {
    same.in_place = std::abs(same.scale - 1) * size < kInPlace && glm::distance(rig[0], (*source)[0]) < kInPlace;
    return same;
  }
  const auto from = axes_by(*source, 0, far, aside), to = axes_by(rig, 0, far, aside);
  if (!from || !to) return std::nullopt;
  same.rig_from_source = glm::normalize(glm::quat_cast(*to * glm::transpose(*from)));
  return alike() ? std::optional(same) : std::nullopt;
}

}  // namespace limber
