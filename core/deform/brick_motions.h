// SPDX-License-Identifier: AGPL-3.0-or-later
// Which motion the tissue of each brick follows. Much of a posed limb follows one bone wholly, or bones that move as
// one: they are counted as one, the first of them.
#pragma once

#include <vector>

#include "core/base/rigid_transform.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct BrickMotions {
  static constexpr int kSeveral = -1;

  std::vector<int> moves_as;  // by bone: the first bone that moves as it does
  std::vector<int> around;    // by brick: what all tissue of it and of the bricks around it moves as, or kSeveral

  //   posed_from_rest  by bone of `weights`
  BrickMotions(const TissueVoxels& tissue, const SkinWeights& weights,
               const std::vector<RigidTransform>& posed_from_rest);
};

}  // namespace limber
