// SPDX-License-Identifier: AGPL-3.0-or-later
// Settings of heat diffusion (heat_diffusion.h), and the report of a computation of weights.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// For each label, the stiffness of its tissue where bones blend, [0.1, 10]; 1 for labels that are not listed. Tissue of
// stiffness 2 blends from one bone to the next over about half the distance.
using BlendStiffness = std::map<Label, double>;

struct HeatDiffusion {
  double residual = 1e-5;  // relative residual (2-norm) at which the solve for a bone stops
  int maximum_iterations = 200;
  BlendStiffness stiffness;
  // Up to this number of tissue voxels, heat is solved for in every voxel. In larger volumes heat is solved for in
  // about as many cells of 2^3 voxels or more (heat_cells.h), and weights are interpolated.
  std::int64_t most_cells = 32'000'000;
};

struct WeightsReport {
  double residual = 0;  // largest relative residual of any bone's solve
  int iterations = 0;   // largest number of iterations of any bone's solve
  // Sentences such as "no bone reaches 213 voxels of label 3 near (..): given to Forearm".
  std::vector<std::string> warnings;
};

}  // namespace limber
