// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/volume/tiled_labels.h"

namespace limber {

// A view of the displacement (posed minus rest position, mm) of each voxel of a posed volume, in rows or in tiles. The
// values must outlive it.
class DisplacementView {
 public:
  DisplacementView() = default;
  // Makes a view of displacements that are stored row by row, x fastest. The view is empty if `count` is 0.
  DisplacementView(const glm::vec3* rows, std::size_t count) : rows_(count > 0 ? rows : nullptr) {}
  DisplacementView(const TiledVectors& tiles) : tiles_(tiles.empty() ? nullptr : &tiles) {}

  bool empty() const { return !rows_ && !tiles_; }
  // Returns the displacement of a voxel of the posed volume, whose grid is `grid`. The view must not be empty.
  const glm::vec3& at(const Grid& grid, const glm::ivec3& voxel) const {
    return tiles_ ? tiles_->at(voxel) : rows_[grid.index(voxel)];
  }

 private:
  const glm::vec3* rows_ = nullptr;
  const TiledVectors* tiles_ = nullptr;
};

}  // namespace limber
