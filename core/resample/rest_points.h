// SPDX-License-Identifier: AGPL-3.0-or-later
// Where the voxels of a posed volume come from. The inverse map exists tile by tile only. Its rest points are kept as
// far as there is room; the others are traced anew where they are asked for.
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

  // The edges of the tiles that keep() is given, but for the last ones.
  static constexpr glm::ivec3 kTile{64, 64, 32};

  //   output  the posed volume, in voxels of the output lattice      room  rest points to be kept, 12 bytes each
  RestPoints(const VoxelRange& output, std::int64_t room, Trace trace);

  // Keeps the rest points of one tile, if there is room; several threads may call it for different tiles.
  void keep(const InverseMap& tile);

  // The rest point of a voxel of the posed volume; 0 where there is no tissue.
  glm::dvec3 at(const glm::ivec3& voxel);

 private:
  struct Row {
    std::uint64_t has_tissue = 0;  // bit x
    std::int64_t first = 0;        // place in points_, where x fastest the tissue voxels follow
  };
  struct Block {
    int asked = 0;
    std::vector<glm::vec3> rest;  // once many were asked for; x fastest
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
  std::vector<std::vector<Row>> tiles_;             // y fastest; none where it was not kept
  std::unordered_map<std::int64_t, Block> blocks_;  // traced; by the lowest voxel's place
};

}  // namespace limber
