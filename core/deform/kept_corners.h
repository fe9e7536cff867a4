// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the posed corners of the bricks that bend, so that they are computed only once: for their bounds, and for every
// tile of the output that the brick reaches. A corner takes 8 bytes: its distance along each axis from the low corner
// of the brick's bounds, in 21 bits. Once a layer of tiles is written, memory of bricks below it is given back.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/deform/output_lattice.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// The bounding box of posed points.
struct FixedBox {
  FixedPoint low, high;
};

class KeptCorners {
 public:
  static constexpr int kSide = TissueVoxels::kBrick + 1;
  using Corners = std::array<FixedPoint, kSide * kSide * kSide>;

  KeptCorners() = default;
  // Makes room for the corners of the bricks whose number in `only_bone` (one per brick) is negative, or of as many of
  // them as fit into `most_bytes`.
  explicit KeptCorners(const std::vector<int>& only_bone, std::int64_t most_bytes = INT64_MAX);

  // Keeps the corners of a brick if there is room, and if `box`, their bounds, is at most 32 voxels large. Corners that
  // belong to no tissue may be anything. Several threads may call this for different bricks.
  void keep(std::int64_t brick, const FixedBox& box, const Corners& corners);
  // Reads the corners of a brick that keep() got with the same `box`. Returns false if they are not kept.
  bool read(std::int64_t brick, const FixedBox& box, Corners& corners) const;
  // Forgets the corners of bricks that lie entirely below `z`, a number of voxels of the output, and gives their memory
  // back. No other function may run meanwhile.
  void forget_below(int z);

 private:
  static constexpr std::int64_t kGroup = 32;  // number of bricks whose memory is given back together

  std::vector<std::int32_t> slot_;         // per brick: its place among the bricks that are kept, -1: it is not
  std::vector<std::int32_t> top_;          // per slot: highest voxel along z that its kept corners reach
  std::vector<std::uint8_t> is_kept_;      // per slot
  ZeroedVector<std::uint64_t> distances_;  // of all corners of each slot
};

}  // namespace limber
