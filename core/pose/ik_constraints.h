// SPDX-License-Identifier: AGPL-3.0-or-later
// The constraints of inverse kinematics while the user drags joints. A pin keeps the tail of a bone in place; a pole is
// a point towards which a limb bends. They are stored by bone name, so that a change of the rig loses only the
// constraints of removed bones.
#pragma once

#include <map>
#include <set>
#include <string>

#include <glm/glm.hpp>

namespace limber {

struct Anchors {
  std::set<std::string> pins;  // bones whose tails stay at their positions
  // For each listed bone, its pole in the world, mm. The limb that ends in the bone bends towards this point.
  std::map<std::string, glm::dvec3> poles;

  bool operator==(const Anchors&) const = default;
};

}  // namespace limber
