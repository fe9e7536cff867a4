// SPDX-License-Identifier: AGPL-3.0-or-later
// How far a pose stretches and presses each tissue: the singular values of F of the tets that hold its voxels. Skin
// that has to cover the outside of a bent joint is stretched there; where in life it would slide over what lies below,
// this says how much of that the model makes up for by stretch.
#pragma once

#include <array>
#include <map>

#include <Eigen/Core>

#include "core/volume/label_volume.h"

namespace limber {

struct TissueModel;

// The 5th, 50th and 95th percentile of its voxels; 1 is as at rest.
struct Stretch {
  std::array<double, 3> least{1, 1, 1}, most{1, 1, 1};  // smallest and largest principal stretch
};

// Of the voxels of each label in tets that bend: not in those that one bone holds wholly, nor between two bones.
//   V  #V posed nodes
std::map<Label, Stretch> stretches(const TissueModel& model, const Eigen::MatrixX3d& V);

}  // namespace limber
