// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/cell_nodes.h"

#include <algorithm>

#include "core/base/disjoint_sets.h"

namespace limber {

CellNodes number_nodes(const std::vector<CellPiece>& pieces, const glm::ivec3& grid_size, int step) {
  const PiecesByCell by_cell(pieces, glm::ivec3(0), (grid_size + step - 1) / step);
  // The corners of pieces in one set become one node.
  DisjointSets joined(8 * pieces.size());
  for (std::size_t a = 0; a < pieces.size(); ++a)
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 next = pieces[a].cell;
      ++next[axis];
      for (const CellPiece& other : by_cell.of(next)) {
        if (!touch(pieces[a], other, axis, step)) continue;
        const auto b = &other - pieces.data();
        for (int corner = 0; corner < 8; ++corner)
          if (corner >> axis & 1)
            joined.unite(static_cast<std::int32_t>(8 * a) + corner,
                         static_cast<std::int32_t>(8 * b) + (corner ^ 1 << axis));
      }
    }
  std::vector<std::int32_t> number(8 * pieces.size(), -1);
  CellNodes nodes;
  nodes.of_piece.resize(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (int corner = 0; corner < 8; ++corner) {
      std::int32_t& mine = number[joined.least(static_cast<std::int32_t>(8 * p) + corner)];
      if (mine < 0) mine = nodes.count++;
      nodes.of_piece[p][corner] = mine;
    }
  return nodes;
}

}  // namespace limber
