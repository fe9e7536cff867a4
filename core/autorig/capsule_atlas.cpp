// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/capsule_atlas.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace limber {

namespace {

double length_of(const Bone& bone) { return glm::distance(bone.head, bone.tail); }

// Returns for each bone the length of the longest path that runs from its head through its descendants to a tail, mm.
std::vector<double> reach_below(const Armature& rig) {
  std::vector<double> reach(rig.bones.size(), 0);
  for (int b = static_cast<int>(std::ssize(rig.bones)); b-- > 0;) {
    reach[b] = std::max(reach[b], length_of(rig.bones[b]));
    if (const int parent = rig.bones[b].parent; parent >= 0)
      reach[parent] = std::max(reach[parent], reach[b] + glm::distance(rig.bones[b].head, rig.bones[parent].head));
  }
  return reach;
}

// Returns a byte per bone: 1 for bones of the trunk. These are the bones to which at least two limbs are attached, and
// all their ancestors.
std::vector<std::uint8_t> trunk_of(const Armature& rig, const std::vector<double>& reach) {
  // A chain of bones counts as a limb if its length is at least this share of the longest path from the root.
  constexpr double kLimb = 0.2;
  const double whole = *std::max_element(reach.begin(), reach.end());
  std::vector<int> limbs(rig.bones.size(), 0);
  for (size_t b = 0; b < rig.bones.size(); ++b)
    if (rig.bones[b].parent >= 0 && reach[b] >= kLimb * whole) ++limbs[rig.bones[b].parent];
  std::vector<std::uint8_t> carries(rig.bones.size(), 0), trunk(carries);
  for (int b = static_cast<int>(std::ssize(rig.bones)); b-- > 0;) {
    carries[b] |= limbs[b] >= 2;
    if (carries[b] && rig.bones[b].parent >= 0) carries[rig.bones[b].parent] = 1;
  }
  bool above = false;
  for (size_t b = 0; b < rig.bones.size(); ++b) {
    above = rig.bones[b].parent < 0 || trunk[rig.bones[b].parent];
    trunk[b] = carries[b] && above;
  }
  return trunk;
}

std::vector<double> radii_of(const Armature& rig, const std::vector<std::uint8_t>& trunk) {
  // Radius of the flesh about a bone: in the trunk kTrunk times the trunk's length, in a limb kLimb times the bone's
  // length. If the parent is in the limb too, the radius is between 0.5 and kTaper times the parent's. It is at least
  // kThinnest / 4 of the summed length of all bones.
  constexpr double kTrunk = 0.2, kLimb = 0.2, kThinnest = 0.012, kTaper = 0.85;
  double trunk_length = 0, whole = 0;
  for (size_t b = 0; b < rig.bones.size(); ++b)
    whole += length_of(rig.bones[b]), trunk_length += trunk[b] ? length_of(rig.bones[b]) : 0;
  std::vector<double> radii(rig.bones.size());
  for (size_t b = 0; b < rig.bones.size(); ++b) {
    const int parent = rig.bones[b].parent;
    double radius = trunk[b] ? kTrunk * trunk_length : kLimb * length_of(rig.bones[b]);
    if (!trunk[b] && parent >= 0 && !trunk[parent])
      radius = std::min(std::max(radius, 0.5 * radii[parent]), kTaper * radii[parent]);
    radii[b] = std::max(radius, kThinnest * whole / 4);
  }
  return radii;
}

// Adds points on the surface of a capsule about a bone, in rings around the bone's axis.
void add_capsule(std::vector<AtlasPoint>& points, const Bone& bone, int number, double radius, double step) {
  const double length = length_of(bone);
  const glm::dvec3 axis = length > 0 ? (bone.tail - bone.head) / length : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(
                       glm::cross(axis, std::abs(axis.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))),
                   v = glm::cross(axis, u);
  const double arc = 1.5707963267948966 * radius, whole = length + 2 * arc;
  const int rows = std::max(4, static_cast<int>(whole / step));
  for (int r = 0; r < rows; ++r) {
    const double s = (r + 0.5) * whole / rows;
    // `s` is the position along the profile of the capsule: one hemisphere, the cylinder, then the other hemisphere.
    const double angle = s < arc ? (s - arc) / radius : s > arc + length ? (s - arc - length) / radius : 0;
    const double along = std::clamp(s - arc, 0.0, length) + radius * std::sin(angle), around = radius * std::cos(angle);
    const int count = std::max(4, static_cast<int>(6.283185307179586 * around / step));
    for (int k = 0; k < count; ++k) {
      const double turn = 6.283185307179586 * (k + 0.5 * (r % 2)) / count;
      const glm::dvec3 out = std::cos(turn) * u + std::sin(turn) * v;
      points.push_back(
          {bone.head + along * axis + around * out, std::cos(angle) * out + std::sin(angle) * axis, number});
    }
  }
}

}  // namespace

BodyAtlas capsule_atlas(const Armature& rig) {
  const std::vector<double> reach = reach_below(rig);
  const double whole = reach.empty() ? 0 : *std::max_element(reach.begin(), reach.end());
  if (!(whole > 0))
    throw Error("a rig without length cannot be fitted", "all its bones are points",
                "give a rig whose bones have lengths");
  const std::vector<double> radii = radii_of(rig, trunk_of(rig, reach));
  BodyAtlas atlas;
  atlas.rig = rig;
  for (int b = 0; b < std::ssize(rig.bones); ++b)
    add_capsule(atlas.skin, rig.bones[b], b, radii[b], std::min(whole / 45, 0.7 * radii[b] + whole / 200));
  // Removes points that are not on the skin, because they are inside the flesh of another bone: nearer to that bone
  // than kInside times the radius of its flesh.
  constexpr double kInside = 0.97;
  std::erase_if(atlas.skin, [&](const AtlasPoint& point) {
    for (int b = 0; b < std::ssize(rig.bones); ++b)
      if (b != point.bone && distance_to_bone(rig.bones[b], point.place) < kInside * radii[b]) return true;
    return false;
  });
  return atlas;
}

bool has_trunk(const Armature& rig) {
  const std::vector<std::uint8_t> trunk = trunk_of(rig, reach_below(rig));
  return std::count(trunk.begin(), trunk.end(), 1) >= 2;
}

}  // namespace limber
