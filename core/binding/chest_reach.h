// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds chests without ribs. Ribs hold the flesh of a chest together. Where a volume has no bone tissue for them (only
// a spine, or only rods along the rig), the flanks lie nearer to the raised arm than to the spine, and would follow it.
// There the bones of the arms count as further away, as much as ribs would be nearer than the spine. All other bones
// share the flesh as ever.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/binding/bone_reach.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Corrects the reaches of the arms and of the chest in a body whose chest has no ribs. Needs a rig whose spine and
// upper arms are recognized by name. Returns true if it has changed a correction.
//   held_by  the bone that holds each tissue voxel, from fixed_bone()
//   reaches  the correction for each bone
bool widen_chest(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                 const ZeroedVector<std::uint16_t>& held_by, std::vector<BoneReach>& reaches);

// Returns the corrections of reaches_of_bones(), with those of widen_chest().
std::vector<BoneReach> reaches_in_body(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                                       const ZeroedVector<std::uint16_t>& held_by);

}  // namespace limber
