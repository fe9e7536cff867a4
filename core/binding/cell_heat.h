// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves for steady heat in HeatCells, the cells of several voxels that are used for very large volumes, for all bones.
//
// The cells are first coarsened twice. These scout cells (4 cells along each axis) are solved for every bone. They show
// in which bricks (blocks of 8^3 voxels) a bone has weight at all, and give the initial guess. Then bones are solved in
// blocks, each only in the cells of its bricks.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/zeroed_vector.h"
#include "core/binding/cell_paths.h"
#include "core/binding/heat_cells.h"
#include "core/binding/heat_settings.h"
#include "core/binding/voxel_heat.h"

namespace limber {

constexpr int kScoutCoarsenings = 2;

// The conductance from a bone to a cell, through faces or at a distance.
struct CellSource {
  std::int32_t cell;
  float conductance;
  float on_scout;  // the part of `conductance` that counts in the scout cell that contains the cell
};

// Returns the sources of each bone. Also adds the conductances of heat at a distance to the diagonal of the cells'
// graph.
//   paths  from paths_to_cells()
std::vector<std::vector<CellSource>> sources_of_bones(const BrickWindow::Source& source, const HeatLaw& law,
                                                      const Armature& armature, const std::vector<CellPath>& paths,
                                                      const std::vector<BoneReach>& reaches, HeatCells& cells);

// The bones' temperatures in each cell, without negligible ones.
struct CellTemperatures {
  struct Entry {
    std::uint16_t bone;
    float value;
  };
  std::vector<std::int64_t> first;  // #cells + 1: index of each cell's first entry
  ZeroedVector<Entry> entries;
};

// Solves for the temperatures of all bones. Throws Error if the residual of a solve stays above that of the
// settings, and Cancelled if the user cancels.
//   most_bytes  memory limit of a block of several bones
CellTemperatures solve_cells(const HeatCells& cells, const std::vector<std::vector<CellSource>>& sources,
                             const Armature& armature, const HeatDiffusion& settings, double most_bytes,
                             const ShareOfProgress& share, Progress& progress, WeightsReport& report);

}  // namespace limber
