// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes weights by heat diffusion through the tissue [after Baran & Popovic 2007, in the volume]. For each rig bone,
// the bone tissue that belongs to it has the fixed temperature 1, and that of all other bones 0. Heat flows through
// soft tissue (never through air) with a conductivity that depends on the kind of tissue. The steady temperatures are
// the weights. Soft tissue also receives heat from the bone that is nearest on a path through the tissue. This keeps
// the blend at a joint as wide as the limb is thick. (flesh_graph.h says how strong this heat is, and from which bone
// it comes near a joint or a collarbone.) A rig bone without bone tissue fixes the temperature of the flesh around its
// axis.
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

// The stiffness of tissues where bones blend, for each label, [0.1, 10]; 1 for labels that are not listed. Tissue of
// stiffness 2 blends from one bone to the next within about half the distance.
using BlendStiffness = std::map<Label, double>;

struct HeatDiffusion {
  double residual = 1e-5;  // relative residual (2-norm) at which the solve for a bone stops
  int maximum_iterations = 200;
  BlendStiffness stiffness;
};

struct WeightsReport {
  double residual = 0;                // largest relative residual of any bone's solve
  int iterations = 0;                 // largest number of iterations of any bone's solve
  std::vector<std::string> warnings;  // "no bone reaches 213 voxels of label 3 near (..): given to Forearm"
};

// Computes the skin weights of a volume. Throws Error when the solve for a bone does not reach its residual.
SkinWeights diffuse_heat(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                         const HeatDiffusion& settings = {}, Progress& progress = no_progress(),
                         WeightsReport* report = nullptr);
// Computes the skin weights of a volume whose bone tissue was already split into parts, one rig bone for each part.
SkinWeights diffuse_heat(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                         const Armature& armature, const BoneParts& parts, const HeatDiffusion& settings = {},
                         Progress& progress = no_progress(), WeightsReport* report = nullptr);

}  // namespace limber
