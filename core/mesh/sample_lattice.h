// SPDX-License-Identifier: AGPL-3.0-or-later
// A lattice of samples over a body, each with its region: what a surface net is drawn over. Cells are as large as asked
// for, half as large around joints, and twice or four times as large deep inside a region, where nothing needs them
// small; cells that touch differ by no more than a factor of two. Coordinates are counted in steps of the smallest.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/lattice_net.h"

namespace limber {

struct SampleLattice {
  struct Cell {
    glm::ivec3 corner;
    int size;  // steps, a power of two, of which `corner` is a multiple
    bool operator==(const Cell&) const = default;
  };

  glm::ivec3 size{0};                   // places for samples
  double step = 0;                      // mm
  double spacing_mm = 0;                // of samples, as it became, but for joints and deep inside
  int usual = 1;                        // size of cells of that spacing
  std::vector<std::uint8_t> cell_size;  // #samples: of the cell in which lies the smallest that begins there
  std::vector<std::uint16_t> label;     // #samples: a region; kAir where no sample is as well
  AffineTransform world_from_lattice;   // mm, turned only
  AffineTransform fine_from_voxel;

  std::int64_t index(const glm::ivec3& p) const {
    return p.x + std::int64_t{size.x} * (p.y + std::int64_t{size.y} * p.z);
  }
  std::uint16_t at(const glm::ivec3& p) const { return label[index(p)]; }
  Cell cell(const glm::ivec3& smallest) const {
    const int s = cell_size[index(smallest)];
    return {smallest & ~(s - 1), s};
  }

  // Whether p has a sample: a corner of a cell.
  bool has_sample(const glm::ivec3& p) const;
  // The cells around sample p, one for each octant; a large one comes several times.
  std::array<Cell, 8> cells_around(const glm::ivec3& p) const;
  // Length of the shortest edge along `axis` that begins at p, 0 if none does.
  int edge_length(const glm::ivec3& p, int axis) const;
  // The cells around that edge, counter-clockwise seen from its end.
  std::array<Cell, 4> cells_around_edge(const glm::ivec3& p, int axis) const;
};

// Where, in a lattice's lists, the smallest cell stands that a voxel's centre lies in.
class SmallestCells {
 public:
  SmallestCells(const SampleLattice& lattice, const Grid& grid);
  std::int64_t operator()(const glm::ivec3& voxel) const {
    return along_[0][voxel.x] + along_[1][voxel.y] + along_[2][voxel.z];
  }

 private:
  std::vector<std::int64_t> along_[3];  // by the voxel's place along each axis
};

// Samples spaced as the settings say over the voxels and a border of air around them; tissue where voxels fill half of
// the cube of one spacing around them. A body must have voxels.
SampleLattice sample_regions(const VoxelRegions& voxels, const LatticeNetSettings& settings);

}  // namespace limber
