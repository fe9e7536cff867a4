// SPDX-License-Identifier: AGPL-3.0-or-later
// The label at a point of a label volume: the one with the largest interpolated membership. Points are in voxel
// coordinates of the volume (voxel centres are whole numbers; outside the grid is air). At a voxel centre every method
// gives that voxel's label, always.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// Which labels may be answered: one byte per label, 0 .. 65535; not 0 where allowed.
using LabelSet = std::vector<std::uint8_t>;

class LabelSampler {
 public:
  // Keeps a reference: the volume must outlive the sampler and not change.
  explicit LabelSampler(const LabelVolume& volume);

  // Of the voxel whose cell the point lies in; cells are half open, [-0.5, 0.5) about the centre.
  Label nearest(const glm::dvec3& point) const;

  // The tissue with the largest membership. Where the nearest voxel is air this is air; where it is tissue the answer
  // is never air: bodies keep their outer border, and no hole opens inside.
  Label tissue(const glm::dvec3& point) const;

  // The same among `allowed` tissues only; 0 when none of them has a share in the neighbourhood.
  Label tissue(const glm::dvec3& point, const LabelSet& allowed) const;

 private:
  const LabelVolume* volume_;
};

}  // namespace limber
