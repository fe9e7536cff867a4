// SPDX-License-Identifier: AGPL-3.0-or-later
// A lattice of samples over a body, each with its region: the input of the surface net (surface_net.h). Cells have the
// requested size, half of it around joints, and two or four times as much deep inside a region, where small cells would
// gain nothing. Sizes of cells that touch differ by a factor of two at most. Coordinates are counted in steps; a step
// is the edge of the smallest cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/lattice_net.h"

namespace limber {

struct SampleLattice {
  struct Cell {
    glm::ivec3 corner;
    int size;  // edge in steps, a power of two; `corner` is a multiple of it
    bool operator==(const Cell&) const = default;
  };

  glm::ivec3 size{0};                   // number of sample positions along each axis
  double step = 0;                      // edge of the smallest cells, mm
  double spacing_mm = 0;                // distance between samples, except around joints and deep inside, mm
  int usual = 1;                        // size in steps of cells with that distance between samples
  std::vector<std::uint8_t> cell_size;  // size in steps of the cell around each smallest cell, by its lowest corner
  std::vector<std::uint16_t> label;     // #samples: the sample's region; kAir also for positions without a sample
  AffineTransform world_from_lattice;   // in mm; rotates and translates only
  AffineTransform fine_from_voxel;

  std::int64_t index(const glm::ivec3& p) const {
    return p.x + std::int64_t{size.x} * (p.y + std::int64_t{size.y} * p.z);
  }
  std::uint16_t at(const glm::ivec3& p) const { return label[index(p)]; }
  Cell cell(const glm::ivec3& smallest) const {
    const int s = cell_size[index(smallest)];
    return {smallest & ~(s - 1), s};
  }

  // Returns whether there is a sample at p: there is one if p is a corner of a cell.
  bool has_sample(const glm::ivec3& p) const;
  // Returns the cells around sample p, one for each octant; a large cell may occur in several octants.
  std::array<Cell, 8> cells_around(const glm::ivec3& p) const;
  // Returns the length in steps of the shortest edge along `axis` that begins at p, 0 if there is none.
  int edge_length(const glm::ivec3& p, int axis) const;
  // Returns the cells around the edge along `axis` that begins at p, counter-clockwise seen from the edge's end.
  std::array<Cell, 4> cells_around_edge(const glm::ivec3& p, int axis) const;
};

// Returns, for a voxel, the index of the smallest cell around its centre in the lattice's arrays.
class SmallestCells {
 public:
  SmallestCells(const SampleLattice& lattice, const Grid& grid);
  std::int64_t operator()(const glm::ivec3& voxel) const {
    return along_[0][voxel.x] + along_[1][voxel.y] + along_[2][voxel.z];
  }

 private:
  std::vector<std::int64_t> along_[3];  // [axis][i]: what coordinate i of a voxel along the axis adds to the index
};

// Places samples, spaced as the settings say, over the voxels and a border of air around them. A sample is tissue if
// voxels fill half of the cube around the sample whose edge is the spacing. The body must have voxels.
SampleLattice sample_regions(const VoxelRegions& voxels, const LatticeNetSettings& settings);

}  // namespace limber
