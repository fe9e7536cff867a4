// SPDX-License-Identifier: AGPL-3.0-or-later
// Weights by heat diffusion through the tissue itself [after Baran & Popovic 2007, in the volume]: every bone part is
// held at 1 for its own rig bone and at 0 for the others, heat flows through soft tissue (never through air) with a
// conductivity by tissue kind, and the steady temperatures are the weights. Flesh is also warmed by the bone nearest to
// it through tissue, which keeps joints as wide as the limb is thick (flesh_graph.h says how strongly, and which bone
// that is beside a hinge or a link). A rig bone without bone tissue holds the flesh around its axis.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_parts.h"
#include "core/rig/armature.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"

namespace limber {

// How stiff tissues are where bones blend, by label, [0.1, 10]; 1 where nothing is said. A tissue of 2 goes over from
// one bone to the next within about half the way.
using BlendStiffness = std::map<Label, double>;

struct HeatDiffusion {
  double residual = 1e-5;  // relative 2-norm at which a bone's solve stops
  int maximum_iterations = 200;
  BlendStiffness stiffness;
};

struct WeightsReport {
  double residual = 0;                // largest over bones, relative
  int iterations = 0;                 // largest over bones
  std::vector<std::string> warnings;  // "no bone reaches 213 voxels of label 3 near (..): given to Forearm"
};

// throws Error when the solve does not reach its residual
SkinWeights diffuse_heat(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                         const HeatDiffusion& settings = {}, Progress& progress = no_progress(),
                         WeightsReport* report = nullptr);
// The same with bones that are split already.
SkinWeights diffuse_heat(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const Armature& armature, const BoneParts& parts, const HeatDiffusion& settings = {},
                         Progress& progress = no_progress(), WeightsReport* report = nullptr);

}  // namespace limber
