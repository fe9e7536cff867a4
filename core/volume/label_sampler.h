// SPDX-License-Identifier: AGPL-3.0-or-later
// The label at a point of a label volume: the one with the largest interpolated membership. Points are in voxel
// coordinates of the volume (voxel centres are whole numbers; outside the grid is air). At a voxel centre every method
// gives that voxel's label, always.
//
// A membership is interpolated between the eight voxels around the point by Hermite's cubic with zero slope at the
// centres, 3 f^2 - 2 f^3: a label holds on near its own voxels, so thin layers survive, and borders between voxels stay
// smooth. A tenth of the eight voxels' mean is then taken off each membership (an unsharp mask), which gives back to
// layers and vessels of one voxel about a third of the volume that any smoothing takes from them. Wider kernels were
// measured on several bodies and angles and lose on all of them: their ringing moves borders by more than they know.
//
// Turning the Bender arm by 45 degrees and back on its own 2 mm grid, Dice over labels of 100 voxels or more, mean /
// weighted by voxels: nearest 0.9201/0.9658, trilinear 0.9210/0.9670, cubic B-spline of 4^3 voxels 0.9270/0.9691,
// Catmull-Rom 0.9299/0.9703, this 0.9334/0.9723 (without the mask 0.9342/0.9729, but vessels lose half as much again).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

class LabelSampler {
 public:
  // Keeps a reference: the volume must outlive the sampler and not change.
  explicit LabelSampler(const LabelVolume& volume);

  // Of the voxel whose cell the point lies in; cells are half open, [-0.5, 0.5) about the centre.
  Label nearest(const glm::dvec3& point) const;

  // The tissue with the largest membership, the nearest voxel's on a tie. Where the nearest voxel is air this is air;
  // where it is tissue the answer is never air: bodies keep their outer border, and no hole opens inside.
  Label tissue(const glm::dvec3& point) const;

  // The largest membership among `allowed` tissues only; 0 when none of them is at one of the eight voxels around.
  Label tissue(const glm::dvec3& point, const LabelSet& allowed) const;

  // How much each allowed tissue of the eight voxels around has of the point: its membership, in no order.
  struct Memberships {
    int count = 0;
    std::array<Label, 8> label;
    std::array<double, 8> share;
  };
  Memberships memberships(const glm::dvec3& point, const LabelSet& allowed) const;

  // The allowed tissue whose voxel is nearest (counted in voxels), at most `reach` voxels away along each axis; 0 when
  // there is none.
  Label nearest_of(const glm::dvec3& point, const LabelSet& allowed, int reach) const;

  // The allowed tissue with most voxels about the point, up to two voxels further than the nearest one: what lies
  // around a bone, and not the thin layer that clings to it. The smaller label on a tie; 0 when none is within `reach`.
  Label prevailing(const glm::dvec3& point, const LabelSet& allowed, int reach) const;

 private:
  struct Neighbours;
  bool neighbours(const glm::dvec3& point, Neighbours& out) const;

  const LabelVolume* volume_;
  std::int64_t row_, slice_;
};

}  // namespace limber
