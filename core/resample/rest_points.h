// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the rest point (position at rest) of every voxel of a posed volume. The inverse map, which contains the rest
// points, is computed and deleted tile by tile. The rest points of tiles are stored until the reserved memory is full.
// All others are computed again on request.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/deform/inverse_map.h"

namespace limber {

class RestPoints {
 public:
  // Sets `map` to the inverse map of a range of voxels of the output lattice.
  using Trace = std::function<void(InverseMap& map, const VoxelRange& range)>;

  // Size in voxels of the tiles given to keep(). Tiles at the upper ends of the grid may be smaller.
  static constexpr glm::ivec3 kTile{64, 64, 32};

  //   output  voxels of the posed volume on the output lattice
  //   room    upper limit on the number of stored rest points, 12 bytes each
  //   trace   is called by at() for rest points that are not stored
  RestPoints(const VoxelRange& output, std::int64_t room, Trace trace);

  // Stores the rest points of one tile if there is room. Several threads may call it for different tiles.
  void keep(const InverseMap& tile);

  // Returns the rest point of a voxel of the posed volume; the zero vector where there is no tissue.
  glm::dvec3 at(const glm::ivec3& voxel);

 private:
  struct Row {
    std::uint64_t has_tissue = 0;  // bit x is 1 if voxel x of the row has tissue
    // Index in points_ of the row's first tissue voxel. The row's other tissue voxels follow along x.
    std::int64_t first = 0;
  };
  struct Block {
    int asked = 0;                // number of the block's points requested so far
    std::vector<glm::vec3> rest;  // rest points of the block, x fastest; empty until more than kMany were requested
  };

  std::int64_t tile_at(const glm::ivec3& voxel) const;
  glm::vec3 kept(const std::vector<Row>& tile, const glm::ivec3& voxel) const;
  glm::vec3 traced(const glm::ivec3& voxel);
  std::vector<glm::vec3> trace_all(const VoxelRange& range) const;

  VoxelRange output_;
  glm::ivec3 tile_count_;
  Trace trace_;
  std::int64_t room_;
  std::atomic<std::int64_t> used_ = 0;
  std::unique_ptr<glm::vec3[]> points_;
  // Rows of each tile, y fastest; an empty list: the tile is not stored.
  std::vector<std::vector<Row>> tiles_;
  std::unordered_map<std::int64_t, Block> blocks_;  // blocks with requested points, by the index of their lowest voxel
};

}  // namespace limber
