// SPDX-License-Identifier: AGPL-3.0-or-later
// A lattice of samples over a body, each with its region: what a surface net is drawn over. Cells have one size, or two:
// blocks of 2^3 fine cells around joints, and whole blocks elsewhere. Coordinates are counted in fine steps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/lattice_net.h"

namespace limber {

struct SampleLattice {
  struct Cell {
    glm::ivec3 corner;
    int size;  // fine steps: 1 or `block`
    bool operator==(const Cell&) const = default;
  };

  glm::ivec3 size{0};  // samples, fine
  double step = 0;     // mm
  int block = 1;       // fine cells along a coarse one: 1 or 2
  glm::ivec3 blocks{0};
  std::vector<std::uint8_t> is_fine;  // #blocks; empty where block is 1
  std::vector<std::uint16_t> label;   // #samples: a region; kAir where no sample is as well
  AffineTransform world_from_lattice;  // mm, turned only
  AffineTransform fine_from_voxel;

  std::int64_t index(const glm::ivec3& p) const { return p.x + std::int64_t{size.x} * (p.y + std::int64_t{size.y} * p.z); }
  std::uint16_t at(const glm::ivec3& p) const { return label[index(p)]; }
  bool fine_cell(const glm::ivec3& c) const {
    const glm::ivec3 b = c >> (block - 1);
    return block == 1 || is_fine[b.x + std::int64_t{blocks.x} * (b.y + std::int64_t{blocks.y} * b.z)];
  }
  Cell cell(const glm::ivec3& fine) const { return fine_cell(fine) ? Cell{fine, 1} : Cell{fine & ~(block - 1), block}; }

  // Whether p has a sample: a corner of a cell.
  bool has_sample(const glm::ivec3& p) const;
  // The cells around sample p, one for each octant; a coarse one comes several times.
  std::array<Cell, 8> cells_around(const glm::ivec3& p) const;
  // Length of the shortest edge along `axis` that begins at p, 0 if none does.
  int edge_length(const glm::ivec3& p, int axis) const;
  // The cells around that edge, counter-clockwise seen from its end.
  std::array<Cell, 4> cells_around_edge(const glm::ivec3& p, int axis) const;
};

// Samples spaced as the settings say over the voxels and a border of air around them; tissue where voxels fill half of the cube of
// one spacing around them. A body must have voxels.
SampleLattice sample_regions(const VoxelRegions& voxels, const LatticeNetSettings& settings);

}  // namespace limber
