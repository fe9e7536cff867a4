// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "core/paint/brush_rule.h"

namespace limber {

// Reads weights for a brush: the weights of single voxels, and interpolated weights between voxels.
class WeightsNearby {
 public:
  explicit WeightsNearby(const BrushView& view) : view_(view) {}

  // Returns the influence of a voxel, or nothing when the voxel is air.
  std::optional<Influence> at(const glm::ivec3& voxel) const {
    if (!view_.body.volume.grid.contains(voxel)) return std::nullopt;
    const std::int64_t place = view_.body.tissue.index_of(voxel);
    if (place < 0) return std::nullopt;
    const int brick = view_.body.tissue.brick_at(voxel);
    return view_.weights(brick)[place - view_.body.tissue.bricks()[brick].first];
  }

  // Adds the weights at a position (voxel coordinates) to `sum`. They are interpolated between those of the eight
  // surrounding voxels that are tissue.
  void add_between(const glm::dvec3& place, WeightSum& sum) const {
    const glm::dvec3 low = glm::floor(place), share = place - low;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 bits(corner & 1, corner >> 1 & 1, corner >> 2);
      double part = 1;
      for (int axis = 0; axis < 3; ++axis) part *= bits[axis] ? share[axis] : 1 - share[axis];
      if (part <= 0) continue;
      if (const auto influence = at(glm::ivec3(low) + bits)) add_to(sum, *influence, part);
    }
  }

 private:
  const BrushView& view_;
};

}  // namespace limber
