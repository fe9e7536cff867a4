// SPDX-License-Identifier: AGPL-3.0-or-later
// The tissue of coarse cells of step^3 voxels, in pieces that hang together: voxels of one cell that touch by faces.
// Two fingers that pass through one cell are two pieces of it, and so are the two sides of a seam. Each piece says how
// much of what influence it gives to the corners of its cell: every voxel its trilinear share, and tissue that follows
// one bone wholly, as bone does, a thousand times as much as what is blended, so that bones stay stiff up to their
// border.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// By axis, the voxels of a cell whose upper face there is cut by a seam; bits as CellPiece::voxels.
using CellCuts = std::array<std::array<std::uint64_t, 8>, 3>;

struct CellPiece {
  // What a piece gives to a corner of its cell; bit 0 of the corner is x, bit 1 y, bit 2 z.
  struct Share {
    int corner, bone;
    float weight;
  };

  // Tissue that follows one bone wholly, as 4^3 places of the cell, x fastest.
  struct Stiff {
    int bone;
    std::uint64_t places;
  };

  glm::ivec3 cell;                                 // holds the voxels cell step .. cell step + step - 1
  std::array<std::uint64_t, 8> voxels;             // bit x + 8 y of word z, from the cell's lowest voxel on
  std::uint64_t places = 0;                        // of the 4^3 of the cell, x fastest, those with tissue of the piece
  std::array<float, 8> away;                       // mm2 from each corner to the nearest voxel
  std::vector<Share> shares;                       // by bone, corners rising
  std::vector<Stiff> stiff;                        // bones rising
  std::shared_ptr<const CellCuts> cuts = nullptr;  // null where no seam is near
};

// The pieces in order of the bricks that hold them; a cell lies in one brick and its pieces behind one another.
//   step  2, 4 or 8    spacing  of voxels, mm
std::vector<CellPiece> cell_pieces(const TissueVoxels& tissue, const SkinWeights& weights, int step,
                                   const glm::dvec3& spacing);
// Of some bricks only.
std::vector<CellPiece> cell_pieces(const TissueVoxels& tissue, const SkinWeights& weights, int step,
                                   const glm::dvec3& spacing, std::span<const std::int64_t> bricks);

// Whether voxels of both touch by faces that are not cut, `b` lying in the next cell along the axis.
bool touch(const CellPiece& a, const CellPiece& b, int axis, int step);

// Pieces by cell.
class PiecesByCell {
 public:
  //   first, size  box of cells that holds them all
  PiecesByCell(const std::vector<CellPiece>& pieces, const glm::ivec3& first, const glm::ivec3& size);
  // Of any cell.
  std::span<const CellPiece> of(const glm::ivec3& cell) const;

 private:
  const std::vector<CellPiece>* pieces_;
  glm::ivec3 first_, size_;
  std::vector<std::int32_t> begin_;  // by cell of the box, -1 without any
};

}  // namespace limber
