// SPDX-License-Identifier: AGPL-3.0-or-later
// What holds limbs while joints are dragged. By the bones' names, as keys are, so that a change of the rig loses only
// what it removed.
#pragma once

#include <map>
#include <set>
#include <string>

#include <glm/glm.hpp>

namespace limber {

struct Anchors {
  std::set<std::string> pins;               // bones whose tails stay where they are
  std::map<std::string, glm::dvec3> poles;  // world, mm: the limb ending in that bone bends towards the point

  bool operator==(const Anchors&) const = default;
};

}  // namespace limber
