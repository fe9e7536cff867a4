// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves any rig to the joints of a fitted body. Joints are matched by their names or, if these differ, by the meaning
// of the names. A spine with another number of vertebrae is spread along the body's spine. A bone without a counterpart
// moves with its parent, with the parent's rotation and scale. Rolls and the axes of joint limits rotate with the
// bones.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/rig/armature.h"

namespace limber {

struct PlacedRig {
  Armature armature;
  // For each bone of the rig, the index of the body's bone to whose joint its head was moved; -1: the bone moves with
  // its parent.
  std::vector<int> joint_of;
};

// Returns the rig moved to the body's joints.
//   joints  position of the joint at the head of each of the body's bones
PlacedRig place_rig(const Armature& rig, const Mannequin& body, const std::vector<glm::dvec3>& joints);

// Rotates and scales a whole rig, and moves it so that its point `from` comes to `to`.
Armature moved_rig(const Armature& rig, const glm::dmat3& turn, double scale, const glm::dvec3& from,
                   const glm::dvec3& to);

// Returns how many of the rig's bones have a counterpart in the body.
int matching_bones(const Armature& rig, const Armature& body);

}  // namespace limber
