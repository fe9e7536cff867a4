// SPDX-License-Identifier: AGPL-3.0-or-later
// Which limbs a rig has, by the roles of its bones, and which limb the name of a tissue means.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// A part of the body that other parts may touch without being one with them.
struct Limb {
  std::vector<bool> has_bone;   // #bones of the rig
  int root = -1;                // the bone that it begins with, where the rig has it
  double grown_together = 0;    // share of the root's length along which it is one with its neighbours by nature
  std::vector<bool> may_touch;  // #bones of the rig: what it can lie against
};

// Arms and legs, then fingers and thumbs. None where the bones' names mean nothing known.
std::vector<Limb> limbs_of(const Armature& armature);

// Whether a point belongs to the part of the limb that is free by nature, told by the bone of the limb nearest to it.
bool is_free(const Limb& limb, const Armature& armature, const glm::dvec3& point);

enum class LimbName { Arms, Legs, Trunk, Head };

// Of names like "Muscle, arms" and "Residual tissue of the legs"; none where a name says nothing of it.
std::optional<LimbName> limb_named(std::string_view tissue_name);
// #bones; none where a bone's name and its parents' mean nothing known.
std::vector<std::optional<LimbName>> limb_of_bones(const Armature& armature);

}  // namespace limber
