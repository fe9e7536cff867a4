// SPDX-License-Identifier: AGPL-3.0-or-later
// Numbers the nodes at the corners of pieces, the connected components of the tissue in each cell (cell_pieces.h).
// Pieces whose tissue touches share the four nodes of the face between them. Neighbouring pieces whose tissue does not
// touch, such as two fingers or the two sides of a seam, have separate nodes [the virtual nodes of Molino, Bao & Fedkiw
// 2004, A virtual node algorithm for changing mesh topology].
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/deform/cell_pieces.h"

namespace limber {

struct CellNodes {
  std::vector<std::array<std::int32_t, 8>> of_piece;  // nodes of each piece; bits 0, 1, 2 of the index: x, y, z
  std::int32_t count = 0;                             // number of nodes
};

// Numbers the nodes in the order of the pieces that use them.
//   step  edge of a cell in voxels: 2, 4 or 8
CellNodes number_nodes(const std::vector<CellPiece>& pieces, const glm::ivec3& grid_size, int step);

}  // namespace limber
