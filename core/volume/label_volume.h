// SPDX-License-Identifier: AGPL-3.0-or-later
// One tissue label per voxel. 0 is air (outside); what a label means stands in the TissueTable beside it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/volume/grid.h"

namespace limber {

using Label = std::uint16_t;

// A byte per label, 0 .. 65535; not 0 for those that belong to the set. Air never counts.
using LabelSet = std::vector<std::uint8_t>;

// A byte per row along x, y + size.y z; not 0 for those that may hold tissue.
using RowSet = std::vector<std::uint8_t>;

struct LabelVolume {
  Grid grid;
  ZeroedVector<Label> voxels;  // grid.voxel_count(), x fastest

  Label at(const glm::ivec3& v) const { return voxels[grid.index(v)]; }
  Label& at(const glm::ivec3& v) { return voxels[grid.index(v)]; }
  // Air outside the grid.
  Label at_or_air(const glm::ivec3& v) const { return grid.contains(v) ? at(v) : Label{0}; }
};

}  // namespace limber
