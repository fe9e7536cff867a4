// SPDX-License-Identifier: AGPL-3.0-or-later
// A lattice of samples over a body, each with its region. It is the input of the surface net (surface_net.h). Cells
// have the requested size, half of it around joints, and two or four times it deep inside a region, where small cells
// would bring no benefit. The sizes of cells that touch differ by a factor of two at most. Coordinates are in steps; a
// step is the edge of the smallest cells.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/voxel_regions.h"

namespace limber {

struct SampleLattice {
  struct Cell {
    glm::ivec3 corner;
    int size;  // edge of the cell in steps, a power of two; `corner` is a multiple of it
    bool operator==(const Cell&) const = default;
  };

  glm::ivec3 size{0};                   // number of sample positions along each axis
  double step = 0;                      // edge of the smallest cells, mm
  double spacing_mm = 0;                // distance between samples, except around joints and deep inside, mm
  int usual = 1;                        // size in steps of cells whose samples are spacing_mm apart
  std::vector<std::uint8_t> cell_size;  // size in steps of the cell around each smallest cell, by its lowest corner
  std::vector<std::uint16_t> label;     // #samples: the sample's region; kAir also for positions without a sample
  // #samples: the region of a sample that is or becomes soft tissue, by the side of seams on which most of the tissue
  // around it lies; empty: kSoft.
  std::vector<std::uint16_t> soft;
  // Rotates and translates without scaling; takes lattice coordinates in mm, not in steps.
  AffineTransform world_from_lattice;
  AffineTransform fine_from_voxel;
  // Faces between voxels at which tissue is not connected, for a lattice whose samples are voxels; null: none. Sample p
  // is then the voxel p + first_voxel.
  const Seams* seams = nullptr;
  glm::ivec3 first_voxel{0};

  // Returns true if a seam cuts the edge of length 1 along `axis` that begins at sample p.
  bool is_cut(const glm::ivec3& p, int axis) const;

  std::int64_t index(const glm::ivec3& p) const {
    return p.x + std::int64_t{size.x} * (p.y + std::int64_t{size.y} * p.z);
  }
  std::uint16_t at(const glm::ivec3& p) const { return label[index(p)]; }
  std::uint16_t soft_at(std::int64_t index) const { return soft.empty() ? TetMesh::kSoft : soft[index]; }
  Cell cell(const glm::ivec3& smallest) const {
    const int s = cell_size[index(smallest)];
    return {smallest & ~(s - 1), s};
  }

  // Returns true if there is a sample at p, which means that p is a corner of a cell.
  bool has_sample(const glm::ivec3& p) const;
  // Returns the cells around sample p, one for each octant; a large cell may occur in several octants.
  std::array<Cell, 8> cells_around(const glm::ivec3& p) const;
  // Returns the length in steps of the shortest edge along `axis` that begins at p, 0 if there is none.
  int edge_length(const glm::ivec3& p, int axis) const;
  // Returns the cells around the edge along `axis` that begins at p, counter-clockwise seen from the edge's end.
  std::array<Cell, 4> cells_around_edge(const glm::ivec3& p, int axis) const;
};

// Finds, for a voxel, the index in the lattice's arrays of the smallest cell around the voxel's centre.
class SmallestCells {
 public:
  SmallestCells(const SampleLattice& lattice, const Grid& grid);
  std::int64_t operator()(const glm::ivec3& voxel) const {
    return along_[0][voxel.x] + along_[1][voxel.y] + along_[2][voxel.z];
  }

 private:
  // [axis][i]: the part of the index that comes from coordinate i of a voxel along the axis.
  std::vector<std::int64_t> along_[3];
};

// Places samples over the voxels and over a border of air around them, with the spacing of the settings. A sample is
// tissue if voxels fill at least half of the cube around it whose edge is the spacing. The body must have voxels.
SampleLattice sample_regions(const VoxelRegions& voxels, const LatticeNetSettings& settings);

// Returns the lattice whose samples are the voxels themselves, with a border of air around the tissue. Cells deep
// inside a region, and away from seams, are up to kDeepest times as large as a voxel. Coordinates are in voxels along
// each axis, counted from sample 0, and so is `world_from_lattice`, the identity. The body must have voxels.
inline constexpr int kDeepest = 8;
SampleLattice sample_voxels(const VoxelRegions& voxels);

}  // namespace limber
