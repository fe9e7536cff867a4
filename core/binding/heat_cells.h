// SPDX-License-Identifier: AGPL-3.0-or-later
// Cells for heat diffusion in very large volumes. The tissue is divided into blocks of 2^3 voxels or more, aligned to
// the bricks (blocks of 8^3 voxels). A cell is a connected set of soft voxels in one block: it never extends across
// air, a bone or a seam, so two fingers that are one voxel apart share no cell, however coarse the blocks are.
//
// Heat flows between cells by the two-point approximation of finite volumes [Eymard, Gallouet, Herbin 2000, "Finite
// Volume Methods", 9]. It flows through each voxel face between two cells, with the distance between the cells'
// centres, and through a face to a bone, with the distance from the cell's centre to the face. The centre of a cell is
// the mean of its voxels' positions, so a cell that a bone or air makes smaller has its centre closer to its border.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/binding/flesh_graph.h"
#include "core/binding/multigrid.h"

namespace limber {

// One side of a cell that touches voxels of a bone.
struct HeldSide {
  std::int32_t cell;
  std::uint16_t bone;
  std::uint8_t direction;  // from the cell to the bone: 0 to 5 for -x, +x, -y, +y, -z, +z
  float conductance;
  glm::i16vec3 nearest;  // the voxel of the bone at this side that is nearest to the cell's centre
};

struct HeatCells {
  static constexpr std::uint16_t kNoCell = 0xFFFF;

  glm::i16vec3 shift{0};                // a block has 2^shift voxels along each axis; shift is 0 to 3
  CellGraph graph;                      // positions are in blocks; the diagonal also contains the losses to bones
  std::vector<glm::vec3> centre;        // mean of the positions of each cell's voxels, in voxels
  std::vector<HeldSide> sides;          // sides of all cells that touch bones, sorted by cell
  std::vector<std::int32_t> side_from;  // #cells + 1: index of each cell's first entry in `sides`
  // #bricks + 1: index of the first red and of the first black cell of each brick.
  std::vector<std::array<std::int32_t, 2>> first;
  // Number of each tissue voxel's cell within its brick, red cells first; kNoCell: a bone holds the voxel.
  std::vector<std::uint16_t> number_in_brick;

  std::int32_t red_cells(std::int64_t brick) const { return first[brick + 1][0] - first[brick][0]; }
  std::int32_t cell_count(std::int64_t brick) const { return red_cells(brick) + first[brick + 1][1] - first[brick][1]; }
  // Returns the index of a cell by its number within a brick.
  std::int32_t cell(std::int64_t brick, std::int32_t number) const {
    const std::int32_t red = red_cells(brick);
    return number < red ? first[brick][0] + number : first[brick][1] + number - red;
  }
};

// Makes the cells of a volume.
//   shift  cells are made in blocks of 2^shift voxels along each axis
HeatCells make_heat_cells(const BrickWindow::Source& source, const HeatLaw& law, const glm::i16vec3& shift);

// Returns the block size, as the `shift` of 2^shift voxels along each axis, with which at most about `most_cells` cells
// have to be solved for. Blocks are made as cubic as possible.
glm::i16vec3 shift_of_cells(const Grid& grid, std::int64_t tissue_voxels, std::int64_t most_cells);

}  // namespace limber
