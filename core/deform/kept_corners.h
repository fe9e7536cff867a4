// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the posed corners of the bricks that bend, so that they are computed only once: for their bounds, and for every
// tile of the output that the brick reaches. A corner takes 8 bytes: its distance along each axis from the low corner
// of the brick's bounds, in 21 bits. Memory is given back as soon as no further tile can need it.
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
  // Makes room for the corners of the bricks whose number in `only_bone` (one per brick) is negative.
  explicit KeptCorners(const std::vector<int>& only_bone);

  // Keeps the corners of a brick, unless `box`, their bounds, is larger than 32 voxels. Several threads may call this
  // for different bricks.
  void keep(std::int64_t brick, const FixedBox& box, const Corners& corners);
  // Reads the corners of a brick that keep() got with the same `box`. Returns false if they are not kept.
  bool read(std::int64_t brick, const FixedBox& box, Corners& corners) const;
  // Forgets the corners of bricks that lie entirely below `z`, a number of voxels of the output, and gives their memory
  // back. No other function may run meanwhile.
  void forget_below(int z);

 private:
  static constexpr std::int64_t kGroup = 32;  // number of bricks whose memory is given back together

  std::vector<std::int32_t> slot_;         // per brick: its place among the bricks that bend, -1: it does not
  std::vector<std::int32_t> top_;          // per slot: highest voxel along z that its corners reach
  std::vector<std::uint8_t> is_kept_;      // per slot
  ZeroedVector<std::uint64_t> distances_;  // of all corners of each slot
};

}  // namespace limber
