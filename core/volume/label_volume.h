// SPDX-License-Identifier: AGPL-3.0-or-later
// Holds one tissue label per voxel. Label 0 is air (outside); the TissueTable of the body describes the other labels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/volume/grid.h"

namespace limber {

using Label = std::uint16_t;

// A set of labels, one byte per label 0 .. 65535: not 0 for labels in the set. Air is never counted as a member.
using LabelSet = std::vector<std::uint8_t>;

// A set of rows along x, one byte per row y + size.y * z: not 0 for rows that may hold tissue.
using RowSet = std::vector<std::uint8_t>;

struct LabelVolume {
  Grid grid;
  ZeroedVector<Label> voxels;  // labels of the grid.voxel_count() voxels, x fastest

  Label at(const glm::ivec3& v) const { return voxels[grid.index(v)]; }
  Label& at(const glm::ivec3& v) { return voxels[grid.index(v)]; }
  // Returns the label of a voxel, and air outside the grid.
  Label at_or_air(const glm::ivec3& v) const { return grid.contains(v) ? at(v) : Label{0}; }
};

}  // namespace limber
