// SPDX-License-Identifier: AGPL-3.0-or-later
// What of a body's bone moves with a shoulder. A rig has one straight bone for the spine and one for each shoulder, and
// the breastbone and upper ribs lie nearer to those than to the spine. Of all that, the collarbone lies along its rig
// bone and the shoulder blade reaches the shoulder joint; the rest is the trunk's, and so is what lies before the
// collarbone begins or on both sides of the body, as the breastbone does.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct ShoulderGirdle {
  int bone;
  int trunk;                // that it springs from
  glm::dvec3 shoulder;      // world, mm: where the upper arm begins
  double reach;             // mm, from there: the shoulder blade comes as near
  glm::dvec3 begin, along;  // world: where the rig bone begins, and its unit direction

  std::optional<glm::dvec3> opposite;  // world, mm: the other shoulder

  bool begins_beyond(const glm::dvec3& place) const { return glm::dot(place - begin, along) < 0; }
  bool is_on_other_side(const glm::dvec3& place) const {
    return opposite && glm::distance(place, *opposite) < glm::distance(place, shoulder);
  }
};

// Of those rig bones whose names mean a shoulder, that have an upper arm and spring from another bone.
std::vector<ShoulderGirdle> shoulder_girdles(const Armature& armature);

}  // namespace limber
