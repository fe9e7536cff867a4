// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how much a pose stretches and compresses each tissue, by the singular values of F in the tets that contain
// its voxels. Skin on the outside of a bent joint is stretched. Real skin would also slide over the tissue below it. In
// the model, tissue slides over bone only (sliding_nodes.h), so skin over muscle is stretched more than real skin is.
#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "core/volume/label_volume.h"

namespace limber {

struct TissueModel;

// The 5th, 50th and 95th percentiles of the principal stretches over a tissue's volume; 1: unchanged length.
struct Stretch {
  std::array<double, 3> least{1, 1, 1}, most{1, 1, 1};  // smallest and largest principal stretch
};

// Returns the stretch of each label over the tets of soft tissue. Leaves out tets that move rigidly (one bone holds all
// their nodes) and tets between two bones.
//   V  #V posed nodes
std::map<Label, Stretch> stretches(const TissueModel& model, const Eigen::MatrixX3d& V);

}  // namespace limber
