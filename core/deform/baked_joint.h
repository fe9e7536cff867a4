// SPDX-License-Identifier: AGPL-3.0-or-later
// A baked joint: the difference between finite elements and blending by dual quaternions, in the flesh around a joint
// at a few of its angles. Solved once (core/bake/bake_joint.h), it makes every pose of the joint look as if it had been
// solved, at the cost of blending.
//
// The joint turns about one axis. At each baked angle the nodes of a lattice store the vector from the blended position
// of the flesh at the node to its solved position, along the axes of the bone above the joint. Between the angles
// shifts follow a cubic curve that passes through the shifts of the baked angles, with the slopes of parabolas through
// three of them [Catmull & Rom 1974, A class of local interpolating splines, for unequal distances]; between the nodes
// they are interpolated trilinearly. At rest the shift is exactly zero.
//
// Kry, James & Pai 2002, EigenSkin, describe correctives of this kind for the joints of a character.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber {

// Hashes (SHA-256) of what a joint was baked from. The joint must not be used on a body with other hashes.
struct BakeSource {
  using Hash = std::array<std::uint8_t, 32>;
  Hash volume{};   // the grid, and the labels of its tissue
  Hash bones{};    // which of the labels are bone
  Hash rig{};      // the bones' names, parents and positions
  Hash weights{};  // the skin weights with which the joint was baked

  bool operator==(const BakeSource&) const = default;
};

// The distances between the baked joint and finite elements at one angle, over the corners of the voxels of soft
// tissue.
struct BakeError {
  double degrees = 0;
  double flesh_mm = 0, skin_mm = 0;  // 95th percentiles of the distances in soft tissue, and in skin
  double largest_mm = 0;

  bool operator==(const BakeError&) const = default;
};

struct BakedJoint {
  std::string bone;             // the rig bone below the joint
  glm::dvec3 axis{0};           // unit axis about which the joint turns, world at rest
  std::vector<double> degrees;  // #A baked angles from rest, ascending; one of them is 0
  BakeSource source;
  std::string glide;                         // how joints glided in the solves: a word of core/body/glide_poses.h
  std::string quality;                       // quality of the tet mesh: draft, normal or fine
  bool contact = true;                       // true: skin touched skin in the solves instead of passing through
  std::vector<BakeError> at_baked, between;  // errors at the baked angles, and at angles between them, ascending

  // Node n of the lattice, a box of `size` nodes, lies at the lowest corner of voxel (first + n) * step.
  glm::ivec3 step{1}, first{0}, size{0};
  std::vector<std::int32_t> nodes;  // #N indices of the nodes that have shifts, in the box with x fastest; ascending
  // #A lists of #N shifts, mm, rounded to half precision. The list for the angle 0 is empty.
  std::vector<std::vector<glm::vec3>> shifts;

  bool operator==(const BakedJoint&) const = default;
};

// Returns the largest value of each error in BakedJoint::between, and the angle of the largest error in flesh or skin.
// All values are zero if the list is empty.
BakeError worst_between(const BakedJoint& joint);

// A rotation split into its part about an axis and the remaining part.
struct TurnAboutAxis {
  double degrees = 0;        // angle about the axis, (-180, 180]
  double other_degrees = 0;  // angle of the remaining rotation, [0, 180]
};
TurnAboutAxis turn_about_axis(const glm::dquat& turn, const glm::dvec3& axis);

// Returns the weights with which the shifts of the baked angles add up to the shift at `angle`: at most four pairs
// (index of the baked angle, weight), ascending by index. The baked angle 0 has no shift and gets no weight. Beyond the
// range of the baked angles, the nearest baked angle has the weight 1.
std::vector<std::pair<int, double>> shares_at(const std::vector<double>& degrees, double angle);

}  // namespace limber
