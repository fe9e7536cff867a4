// SPDX-License-Identifier: AGPL-3.0-or-later
// Interpolates the temperatures of HeatCells to the voxels of the tissue: trilinearly between the centres of a cell and
// of the cells that are linked to it. On a side that touches a bone, the bone's own temperature is used at the bone's
// surface; towards air and seams, the temperature is constant. So no weight crosses air.
#pragma once

#include "core/binding/cell_heat.h"
#include "core/skin/top_four.h"

namespace limber {

// Offers the temperatures of all soft voxels to `best`, which keeps the four largest of each voxel. Leaves out the
// bricks (blocks of 8^3 voxels) `except`.
//   except  indices of bricks, ascending
void interpolate_cells(const TissueVoxels& tissue, const HeatCells& cells, const std::vector<std::int32_t>& except,
                       const CellTemperatures& temperatures, BestFour& best);

}  // namespace limber
