// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves for the temperatures of single voxels in bricks (blocks of 8^3 voxels) between two bones, if the rest of the
// body was solved for in cells of several voxels. In the gap of a joint the weight rises from 0 to 1 within a few
// voxels, which cells cannot resolve. At the border of these bricks, the interpolated temperatures of the cells are
// prescribed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/binding/cell_heat.h"
#include "core/binding/voxel_heat.h"

namespace limber {

// Returns the bricks that have two or more bones nearby: within one brick for cells of 2^3 voxels, within more bricks
// for coarser cells. The result is ascending.
//   shift  cells have 2^shift voxels along each axis (HeatCells::shift)
std::vector<std::int32_t> bricks_between_bones(const TissueVoxels& tissue, const ZeroedVector<std::uint16_t>& held_by,
                                               const glm::i16vec3& shift);

struct SolvedCells {
  const HeatCells& cells;
  const std::vector<CellPath>& paths;
  const CellTemperatures& temperatures;
};

// Solves for the voxels of the given bricks. `best` must contain the temperatures of the other bricks.
//   most_bytes  memory limit of a block of several bones
void solve_joints(const HeatBody& body, const HeatDiffusion& settings, const std::vector<std::int32_t>& bricks,
                  const SolvedCells& solved, double most_bytes, const ShareOfProgress& share, Progress& progress,
                  BestFour& best, WeightsReport& report);

}  // namespace limber
