// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes phantoms, which are procedural sample bodies at any voxel spacing: an arm with separate fingers, and a whole
// body. Each phantom has a matching rig with joint limits, a tissue table and a short motion.
#pragma once

#include "core/base/progress.h"
#include "core/motion/bvh.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct Phantom {
  LabelVolume volume;
  TissueTable tissues;
  Armature armature;
  Motion motion;
};

Phantom make_arm_phantom(double spacing_mm = 2, Progress& progress = no_progress());
Phantom make_body_phantom(double spacing_mm = 4, Progress& progress = no_progress());

}  // namespace limber
