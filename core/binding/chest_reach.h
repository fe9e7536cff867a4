// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds chests without ribs. Ribs hold the flesh of a chest together. If a volume has no bone tissue for them (only a
// spine, or only rods along the rig), the flanks are nearer to the raised arm than to the spine, and would follow the
// arm. In such bodies the distances to the bones of the arms are increased, as much as ribs would reduce the distance
// to the chest. Flesh is divided among all other bones as usual.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/binding/bone_reach.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Corrects the reaches of the arms and of the chest in a body whose chest has no ribs. The spine and the upper arms of
// the rig must be recognized by name. Returns true if a correction was changed.
//   held_by  the bone that holds each tissue voxel, from fixed_bone()
//   reaches  in, out: the correction for each bone
bool widen_chest(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                 const ZeroedVector<std::uint16_t>& held_by, std::vector<BoneReach>& reaches);

// Returns the corrections of reaches_of_bones(), changed by widen_chest().
std::vector<BoneReach> reaches_in_body(const Grid& grid, const TissueVoxels& tissue, const Armature& armature,
                                       const ZeroedVector<std::uint16_t>& held_by);

}  // namespace limber
