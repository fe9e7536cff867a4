// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the limbs of a rig by the anatomical roles of its bones, and the limb that is part of a tissue's name.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// A limb or finger. Other parts of the body may touch it without being connected to it.
struct Limb {
  std::vector<bool> has_bone;  // #bones of the rig: true for bones of the limb
  int root = -1;               // the limb's first bone, whose parent is not in the limb; -1: none
  // Share of the root bone's length, counted from its head, along which the limb's flesh is continuous with the body.
  double grown_together = 0;
  std::vector<bool> may_touch;  // #bones of the rig: true for bones that the limb can touch
};

// Returns the rig's arms and legs, then its thumbs and fingers; none when no bone's name is recognized.
std::vector<Limb> limbs_of(const Armature& armature);

// Returns true if a point is in the part of the limb that is not grown together with the body: further along the root
// bone than the share `grown_together`, or nearest to another bone of the limb.
bool is_free(const Limb& limb, const Armature& armature, const glm::dvec3& point);

enum class LimbName { Arms, Legs, Trunk, Head };

// Returns the limb that a tissue's name contains, as in "Muscle, arms" or "Residual tissue of the legs"; nothing for a
// name without a limb.
std::optional<LimbName> limb_named(std::string_view tissue_name);
// Returns the limb of each bone; nothing for a bone when neither its name nor any ancestor's is recognized.
std::vector<std::optional<LimbName>> limb_of_bones(const Armature& armature);

}  // namespace limber
