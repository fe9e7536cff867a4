// SPDX-License-Identifier: AGPL-3.0-or-later
// Splits the tissue in coarse cells of step^3 voxels into pieces: the connected components (by faces) of the tissue in
// one cell. Two fingers that pass through one cell are two pieces, and so are the two sides of a seam. Each piece gives
// bone weights to the corners of its cell: the sum of its voxels' weights, each multiplied by the corner's trilinear
// weight at the voxel. Tissue that follows one bone with full weight, as bone does, counts a thousand times as much as
// blended tissue, so that bones stay rigid up to their border.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// The voxels of a cell whose upper face along an axis (the first index) a seam cuts. Voxel (x, y, z) is bit x + 8 y of
// word z.
using CellCuts = std::array<std::array<std::uint64_t, 8>, 3>;

struct CellPiece {
  // The weight of a bone that a piece gives to a corner of its cell. Bits 0, 1 and 2 of the corner's index are x, y and
  // z.
  struct Share {
    int corner, bone;
    float weight;
  };

  // The tissue of the piece that follows one bone with full weight: bits for the 4^3 subcells of the cell, x fastest.
  struct Stiff {
    int bone;
    std::uint64_t places;
  };

  glm::ivec3 cell;                      // the cell contains the voxels from cell * step to cell * step + step - 1
  std::array<std::uint64_t, 8> voxels;  // the piece's voxels: voxel (x, y, z) of the cell is bit x + 8 y of word z
  // One bit for each of the 4^3 subcells, x fastest: 1 if it has tissue of the piece.
  std::uint64_t places = 0;
  std::array<float, 8> away;  // squared distance of each corner from the piece's nearest voxel, mm2
  // Bone weights that the piece gives to the corners, grouped by bone, then ascending by corner.
  std::vector<Share> shares;
  std::vector<Stiff> stiff;                        // tissue that follows one bone with full weight, ascending by bone
  std::shared_ptr<const CellCuts> cuts = nullptr;  // faces that a seam cuts; null: no face is cut
};

// Returns the pieces of all cells in the order of their bricks. Pieces of one cell are adjacent. A cell never extends
// over several bricks.
//   step     edge of a cell in voxels: 2, 4 or 8
//   spacing  size of a voxel, mm
std::vector<CellPiece> cell_pieces(const TissueVoxels& tissue, const SkinWeights& weights, int step,
                                   const glm::dvec3& spacing);
// Does the same as cell_pieces() above, but only for the given bricks (indices into tissue.bricks()).
std::vector<CellPiece> cell_pieces(const TissueVoxels& tissue, const SkinWeights& weights, int step,
                                   const glm::dvec3& spacing, std::span<const std::int64_t> bricks);

// Returns true if a voxel of piece `a` and a voxel of piece `b` share a face that no seam cuts. The cell of `b` must be
// the upper neighbour, along `axis`, of the cell of `a`.
bool touch(const CellPiece& a, const CellPiece& b, int axis, int step);

// Finds the pieces of a cell: the parts of the cell's tissue that move separately.
class PiecesByCell {
 public:
  // Finds where the pieces of each cell begin. `pieces` must outlive this object.
  //   first, size  lowest cell and size of a box of cells that contains all pieces
  PiecesByCell(const std::vector<CellPiece>& pieces, const glm::ivec3& first, const glm::ivec3& size);
  // Returns the pieces of a cell, which may lie outside the box.
  std::span<const CellPiece> of(const glm::ivec3& cell) const;

 private:
  const std::vector<CellPiece>* pieces_;
  glm::ivec3 first_, size_;
  std::vector<std::int32_t> begin_;  // index of the first piece of each cell of the box; -1: the cell has no piece
};

}  // namespace limber
