// SPDX-License-Identifier: AGPL-3.0-or-later
// Stores the posed corners of the bricks that a pose bends, so that they are computed only once although they are
// needed for the bricks' bounds and for every tile of the output that a brick reaches. A corner takes 8 bytes: its
// distance along each axis from the low corner of the brick's bounds, 21 bits each. After a layer of tiles is written,
// the memory of the bricks below it is freed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/deform/output_lattice.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Bounding box of posed points.
struct FixedBox {
  FixedPoint low, high;
};

class KeptCorners {
 public:
  static constexpr int kSide = TissueVoxels::kBrick + 1;
  using Corners = std::array<FixedPoint, kSide * kSide * kSide>;

  KeptCorners() = default;
  // Reserves memory for the corners of the bricks that follow several bones, or for as many of these bricks as fit into
  // `most_bytes`.
  //   only_bone  for each brick, the one bone that it follows; negative: several bones
  explicit KeptCorners(const std::vector<int>& only_bone, std::int64_t most_bytes = INT64_MAX);

  // Stores the corners of a brick if memory was reserved for it, and if `box`, the corners' bounding box, is at most 32
  // voxels long on each axis. Corners without tissue may have any value. Several threads may call this for different
  // bricks.
  void keep(std::int64_t brick, const FixedBox& box, const Corners& corners);
  // Reads the corners of a brick that were stored by keep() with the same `box`. Returns false if they are not stored.
  bool read(std::int64_t brick, const FixedBox& box, Corners& corners) const;
  // Frees the memory of the corners of bricks that are entirely below `z` (output voxels). No other function may run at
  // the same time.
  void forget_below(int z);

 private:
  static constexpr std::int64_t kGroup = 32;  // number of bricks whose memory is freed together

  std::vector<std::int32_t> slot_;         // for each brick: its index among the stored bricks (slot); -1: not stored
  std::vector<std::int32_t> top_;          // for each slot: largest z of the output voxels that its posed corners reach
  std::vector<std::uint8_t> is_kept_;      // for each slot: 1 if its corners are stored
  ZeroedVector<std::uint64_t> distances_;  // packed corners of each slot
};

}  // namespace limber
