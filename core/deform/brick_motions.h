// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the bricks (blocks of 8^3 voxels) whose tissue moves with one bone. Much of a posed limb follows one bone with
// full weight, or several bones with the same motion. The first bone with a motion stands for all bones that have this
// motion.
#pragma once

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct BrickMotions {
  static constexpr int kSeveral = -1;

  std::vector<int> moves_as;  // for each bone, the first bone with the same motion
  std::vector<int> around;    // for each brick, the bone that it and its neighbours all follow, or kSeveral

  //   posed_from_rest  motions of the bones of `weights`
  BrickMotions(const TissueVoxels& tissue, const SkinWeights& weights,
               const std::vector<RigidTransform>& posed_from_rest);
};

}  // namespace limber
