// SPDX-License-Identifier: AGPL-3.0-or-later
// Any rig laid over the joints of a fitted body. Joints meet by their names, else by what the names mean; a spine with
// other vertebrae is spread along the body's own; what has no counterpart rides with the bone it hangs from, turned and
// scaled as that one is. Rolls and the axes of joint limits turn along.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/rig/armature.h"

namespace limber {

struct PlacedRig {
  Armature armature;
  std::vector<int> joint_of;  // per bone: the body's bone that gave its head, -1 where it rides along
};

//   joints  where the body's joints lie, by its bones
PlacedRig place_rig(const Armature& rig, const Mannequin& body, const std::vector<glm::dvec3>& joints);

// Every bone by one turn, scale and shift.
Armature moved_rig(const Armature& rig, const glm::dmat3& turn, double scale, const glm::dvec3& from,
                   const glm::dvec3& to);

// How many of the rig's bones have a counterpart.
int matching_bones(const Armature& rig, const Armature& body);

}  // namespace limber
