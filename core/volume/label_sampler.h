// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the label at a point of a label volume: the one with the largest interpolated membership. Points are in voxel
// coordinates of the volume (voxel centres are whole numbers; outside the grid is air). At a voxel centre every method
// returns that voxel's label.
//
// A label's membership is interpolated between the eight voxels around the point by Hermite's cubic with zero slope at
// the voxel centres, 3 f^2 - 2 f^3. So a label's membership stays high near its own voxels: thin layers survive, and
// borders between labels stay smooth. Then a tenth of the eight voxels' mean is subtracted from each membership (an
// unsharp mask). Layers and vessels of one voxel so regain about a third of the volume that they lose by smoothing.
// Wider kernels were measured on several bodies and angles and were worse on all of them: their ringing moves borders.
//
// Measured on the Bender arm, turned by 45 degrees and back on its own 2 mm grid. The numbers are the Dice coefficient
// of labels of 100 voxels or more, as plain mean / mean weighted by voxels. Nearest voxel: 0.9201/0.9658. Trilinear:
// 0.9210/0.9670. Cubic B-spline of 4^3 voxels: 0.9270/0.9691. Catmull-Rom: 0.9299/0.9703. This method: 0.9334/0.9723;
// without the unsharp mask 0.9342/0.9729, but vessels then lose half as much volume again.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

class LabelSampler {
 public:
  // Keeps a reference to the volume, which must outlive the sampler and must not change.
  explicit LabelSampler(const LabelVolume& volume);

  // Returns the label of the voxel whose cube contains the point: [-0.5, 0.5) around the voxel's centre along each
  // axis.
  Label nearest(const glm::dvec3& point) const;

  // Returns the tissue label with the largest membership; on a tie, that of the nearest voxel. When the nearest voxel
  // is air, the result is air; when it is tissue, the result is never air. So a body keeps its outer border and gets
  // no holes.
  Label tissue(const glm::dvec3& point) const;

  // Returns the label with the largest membership among the `allowed` tissues; 0 when none of the eight voxels around
  // the point has one of them.
  Label tissue(const glm::dvec3& point, const LabelSet& allowed) const;

  // The memberships, at a point, of the allowed labels among the eight voxels around the point. The order is not
  // defined.
  struct Memberships {
    int count = 0;
    std::array<Label, 8> label;
    std::array<double, 8> share;
  };
  Memberships memberships(const glm::dvec3& point, const LabelSet& allowed) const;

  // Returns the label of the nearest voxel whose label is in `allowed`. Distances are measured in voxels. Only voxels
  // up to `reach` voxels away along each axis are searched; the result is 0 if none of them has an allowed label.
  Label nearest_of(const glm::dvec3& point, const LabelSet& allowed, int reach) const;

  // Returns the allowed label with the most voxels around the point. Voxels count if they are at most two voxels
  // farther away than the nearest voxel with an allowed label. So near a bone the result is the tissue that surrounds
  // the bone, and not a thin layer on it. Returns the smaller label on a tie, and 0 if no voxel with an allowed label
  // is within `reach` voxels along each axis.
  Label prevailing(const glm::dvec3& point, const LabelSet& allowed, int reach) const;

 private:
  struct Neighbours;
  bool neighbours(const glm::dvec3& point, Neighbours& out) const;

  const LabelVolume* volume_;
  std::int64_t row_, slice_;
};

}  // namespace limber
