// SPDX-License-Identifier: AGPL-3.0-or-later
// Decides which bone tissue moves with a shoulder. A rig has a straight bone for the spine and one for each shoulder,
// and the breastbone and upper ribs lie nearer to the shoulder's rig bones than to the spine's. Only the collarbone,
// which lies along its rig bone, and the shoulder blade, which reaches the shoulder joint, move with the shoulder. All
// other bones belong to the trunk, such as the breastbone. So do bones on both sides of the body, and bones that lie
// before the beginning of the collarbone, measured along its rig bone.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct ShoulderGirdle {
  int bone;                 // rig bone of the shoulder
  int trunk;                // rig bone of the trunk that the shoulder is attached to
  glm::dvec3 shoulder;      // head of the upper arm; world, mm
  double reach;             // distance from the shoulder joint within which the shoulder blade comes, mm
  glm::dvec3 begin, along;  // head of the rig bone in world coordinates, mm, and its unit direction

  std::optional<glm::dvec3> opposite;  // the other shoulder; world, mm

  bool begins_beyond(const glm::dvec3& place) const { return glm::dot(place - begin, along) < 0; }
  bool is_on_other_side(const glm::dvec3& place) const {
    return opposite && glm::distance(place, *opposite) < glm::distance(place, shoulder);
  }
};

// Returns the girdles of all rig bones whose names mean a shoulder and that have an upper arm and a parent.
std::vector<ShoulderGirdle> shoulder_girdles(const Armature& armature);

}  // namespace limber
