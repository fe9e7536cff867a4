// SPDX-License-Identifier: AGPL-3.0-or-later
// Decides which bone tissue moves with a shoulder. A rig has a straight bone for the spine and one for each shoulder,
// and the breastbone and upper ribs are nearer to the shoulder's rig bones than to the spine's. Only the collarbone,
// which lies along its rig bone, and the shoulder blade, which reaches the shoulder joint, move with the shoulder. All
// other bones, such as the breastbone, belong to the trunk. So do bones that reach across to the other side of the
// body, and bones before the beginning of the collarbone, measured along its rig bone.
#pragma once

#include <optional>
#include <vector>

#include "core/rig/armature.h"

namespace limber {

struct ShoulderGirdle {
  int bone;                 // rig bone of the collarbone
  int trunk;                // rig bone of the trunk to which the collarbone is attached
  glm::dvec3 shoulder;      // the shoulder joint: head of the upper arm's rig bone; world, mm
  double reach;             // tissue within this distance of the shoulder joint is shoulder blade, mm
  glm::dvec3 begin, along;  // head of the collarbone's rig bone (world, mm), and the bone's unit direction

  std::optional<glm::dvec3> opposite;  // shoulder joint on the body's other side; world, mm

  bool begins_beyond(const glm::dvec3& place) const { return glm::dot(place - begin, along) < 0; }
  bool is_on_other_side(const glm::dvec3& place) const {
    return opposite && glm::distance(place, *opposite) < glm::distance(place, shoulder);
  }
};

// Returns a girdle for each rig bone that, by its name, is a collarbone and that has an upper arm as child and a bone
// of the trunk as ancestor.
std::vector<ShoulderGirdle> shoulder_girdles(const Armature& armature);

}  // namespace limber
