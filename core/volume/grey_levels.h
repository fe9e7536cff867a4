// SPDX-License-Identifier: AGPL-3.0-or-later
// Holds a grey image (CT, MR) with 16 bits per voxel, as pictures need it: half the memory of floats, and the format
// that graphics cards filter. In a CT that spans 4096 Hounsfield units, a value is stored with an error of at most 1/32
// unit.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/volume/grid.h"

namespace limber {

struct GreyLevels {
  static constexpr int kBlock = 8;  // edge of the blocks of `ranges`, voxels

  Grid grid;
  double least = 0, step = 1;         // the value of level L is least + step * L
  std::vector<std::uint16_t> levels;  // levels of the grid.voxel_count() voxels, x fastest
  // The least and the largest level of each block of voxels and of the voxels beside it, x fastest. So no value that is
  // interpolated between the voxel centres of a block is outside the block's range.
  std::vector<std::array<std::uint16_t, 2>> ranges;

  glm::ivec3 blocks() const { return (grid.size + kBlock - 1) / kBlock; }
  double most() const { return least + step * 65535; }
  double value_of(std::uint16_t level) const { return least + step * level; }
  double value_at(const glm::ivec3& voxel) const {
    return value_of(levels[static_cast<std::size_t>(grid.index(voxel))]);
  }
};

// Returns the image. Values that are not finite become the least value.
//   values  grid.voxel_count() values, x fastest
GreyLevels grey_levels(const Grid& grid, std::span<const float> values);

// Returns the image at half its resolution: each voxel has the mean of 2^3 voxels, fewer at the image's upper faces.
GreyLevels halved(const GreyLevels& image);

// Returns {level, width}, the middle and the size of the window that shows most of an image: from the 1 % quantile to
// the 99 % quantile of the values.
std::array<double, 2> usual_window(const GreyLevels& image);

}  // namespace limber
