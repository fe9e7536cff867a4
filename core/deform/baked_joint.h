// SPDX-License-Identifier: AGPL-3.0-or-later
// A baked joint: what finite elements do to the flesh around a joint beyond what blending by dual quaternions does, at
// a few angles of the joint. Solved once (core/bake/bake_joint.h), it makes every pose of the joint look as if it had
// been solved, at the cost of blending.
//
// The joint turns about one axis. At each baked angle the nodes of a lattice hold the shift from the blended place of
// the flesh there to its solved place, along the axes of the bone above the joint. Between the angles shifts follow a
// cubic curve that passes through the shifts of the baked angles, with the slopes of parabolas through three of them
// [Catmull & Rom 1974, A class of local interpolating splines, for unequal distances]; between the nodes they are
// interpolated trilinearly. At rest the shift is exactly zero.
//
// Joints with cardinal correctives of this kind: Kry, James & Pai 2002, EigenSkin.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber {

// Hashes (SHA-256) of what a joint was baked from. A body with other hashes must not use it.
struct BakeSource {
  using Hash = std::array<std::uint8_t, 32>;
  Hash volume{};   // the grid, and the labels of its tissue
  Hash bones{};    // which of the labels are bone
  Hash rig{};      // the bones' names, parents and positions
  Hash weights{};  // the skin weights

  bool operator==(const BakeSource&) const = default;
};

// How far a baked joint is from finite elements at one angle, over the corners of the voxels of soft tissue.
struct BakeError {
  double degrees = 0;
  double flesh_mm = 0, skin_mm = 0;  // 95 % of all soft tissue, and of skin, are nearer
  double largest_mm = 0;

  bool operator==(const BakeError&) const = default;
};

struct BakedJoint {
  std::string bone;             // the rig bone below the joint
  glm::dvec3 axis{0};           // unit axis about which the joint turns, world at rest
  std::vector<double> degrees;  // #A baked angles from rest, ascending; one of them is 0
  BakeSource source;
  std::string glide;                         // the word of core/body/glide_poses.h by which joints glided
  std::string quality;                       // of the tets: draft, normal or fine
  bool contact = true;                       // whether skin touched skin instead of passing through
  std::vector<BakeError> at_baked, between;  // errors at the baked angles, and at angles between them, ascending

  // Node n of the box `size` lies at the corner (first + n) * step of the voxels: corner c is the lowest corner of
  // voxel c.
  glm::ivec3 step{1}, first{0}, size{0};
  std::vector<std::int32_t> nodes;  // #N places in the box, x fastest, of the nodes that have shifts; ascending
  // #A lists of #N shifts, mm, in the precision of half floats; the list of the angle 0 is empty.
  std::vector<std::vector<glm::vec3>> shifts;

  bool operator==(const BakedJoint&) const = default;
};

// Returns the error between baked angles that is largest by its skin_mm or flesh_mm; zero if none is known.
BakeError worst_between(const BakedJoint& joint);

// The turn of a joint as far as it is about an axis.
struct TurnAboutAxis {
  double degrees = 0;        // (-180, 180]
  double other_degrees = 0;  // the angle of the rest of the turn, [0, 180]
};
TurnAboutAxis turn_about_axis(const glm::dquat& turn, const glm::dvec3& axis);

// Returns the share of each baked angle in the shifts at an angle, at most four of them, ascending by angle; no share
// for the angle 0. Angles beyond the baked ones count as the last of them.
std::vector<std::pair<int, double>> shares_at(const std::vector<double>& degrees, double angle);

}  // namespace limber
