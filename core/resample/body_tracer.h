// SPDX-License-Identifier: AGPL-3.0-or-later
// Traces the voxels of a posed body back to the body at rest: fills the inverse map (posed voxel to position at rest)
// of any range of output voxels. The bounding boxes of the posed bricks and pieces of bone are sorted into bins, so
// that only those near the range are examined.
#pragma once

#include <vector>

#include "core/deform/box_bins.h"
#include "core/deform/inverse_map.h"
#include "core/deform/posed_tets.h"

namespace limber {

class BodyTracer {
 public:
  // Keeps references to all arguments.
  //   tets      nullptr: posed without finite elements
  //   priority  by label: where tissues overlap, the tissue with the higher priority is kept
  //   output    voxels of the posed volume on the output lattice; tissue beyond them is left out
  //   nearest   true: bone is painted where the nearest voxel at rest is bone, without interpolation
  BodyTracer(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets, const TissueDepth* depth,
             const std::vector<int>& priority, const LabelSampler& sampler, const VoxelRange& output, bool nearest);

  // Fills the inverse map of a range of voxels. Returns false, without filling it, if no tissue reaches the range and
  // `even_if_empty` is false.
  bool fill(InverseMap& map, const VoxelRange& range, bool even_if_empty) const;

 private:
  const PosedLattice& lattice_;
  const RigidBones& bones_;
  const PosedTets* tets_;
  const TissueDepth* depth_;
  const std::vector<int>& priority_;
  const LabelSampler& sampler_;
  const bool nearest_;
  BoxBins bricks_, pieces_;
};

}  // namespace limber
