// SPDX-License-Identifier: AGPL-3.0-or-later
// Hashes the data that a joint is baked from, so that a baked joint is refused on another body.
#pragma once

#include "core/deform/baked_joint.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Returns the hashes of the data of a body from which its joints are baked.
//   is_bone  1 for each label that is bone tissue
//   weights  the bound weights, before bone tissue is made rigid
BakeSource bake_source(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                       const Armature& armature, const SkinWeights& weights);

// Throws Error, which says what differs, if a joint was baked from another body.
void check_source(const BakedJoint& joint, const BakeSource& body);

}  // namespace limber
