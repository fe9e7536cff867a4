// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/cell_pieces.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include "core/base/parallel.h"

namespace limber {

namespace {

using Voxels = std::array<std::uint64_t, 8>;

// Factor on the weights that a voxel gives to its cell's corners if the voxel follows one bone with full weight. The
// large factor keeps bones rigid up to their border.
constexpr double kHold = 1000;
constexpr int kGrain = 16;  // number of bricks that one parallel task handles
constexpr std::uint64_t kFirstColumn = 0x0101010101010101, kLastColumn = kFirstColumn << 7;

bool is_empty(const Voxels& voxels) {
  return std::all_of(voxels.begin(), voxels.end(), [](std::uint64_t slice) { return slice == 0; });
}

// Returns the connected component that contains the first of `voxels`.
//   cuts  voxel faces that a seam cuts: the two voxels beside such a face are not connected through it; null: no cut
Voxels first_piece(const Voxels& voxels, const CellCuts* cuts) {
  const auto open = [&](int axis, int z) { return cuts ? ~(*cuts)[axis][z] : ~std::uint64_t{0}; };
  Voxels piece{};
  const auto slice = std::find_if(voxels.begin(), voxels.end(), [](std::uint64_t each) { return each != 0; });
  piece[slice - voxels.begin()] = *slice & -*slice;
  for (bool grown = true; grown;) {
    grown = false;
    for (int z = 0; z < 8; ++z) {
      const std::uint64_t here = piece[z];
      const std::uint64_t around = here | (here & open(0, z) & ~kLastColumn) << 1 |
                                   ((here & ~kFirstColumn) >> 1 & open(0, z)) | (here & open(1, z)) << 8 |
                                   (here >> 8 & open(1, z)) | (z > 0 ? piece[z - 1] & open(2, z - 1) : 0) |
                                   (z < 7 ? piece[z + 1] & open(2, z) : 0);
      piece[z] = around & voxels[z];
      grown = grown || piece[z] != here;
    }
  }
  return piece;
}

// Returns the tissue voxels of one cell (a cube of step^3 voxels) in a brick.
//   low  the cell's lowest voxel, relative to the brick's lowest voxel
Voxels voxels_of(const TissueVoxels::Brick& brick, const glm::ivec3& low, int step) {
  std::uint64_t rows = 0;
  for (int y = 0; y < step; ++y) rows |= ((std::uint64_t{1} << step) - 1) << (8 * y);
  Voxels voxels{};
  for (int z = 0; z < step; ++z) voxels[z] = brick.mask[low.z + z] >> (low.x + 8 * low.y) & rows;
  return voxels;
}

// Returns which faces of a cell's voxels a seam cuts; null if it cuts none of them.
//   lowest  the cell's lowest voxel
std::shared_ptr<const CellCuts> cuts_of(const Seams& seams, const Voxels& voxels, const glm::ivec3& lowest) {
  CellCuts cuts{};
  bool any = false;
  for (int z = 0; z < 8; ++z)
    for (std::uint64_t bits = voxels[z]; bits; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      for (int axis = 0; axis < 3; ++axis)
        if (seams.is_cut(lowest + glm::ivec3(bit & 7, bit >> 3, z), axis)) cuts[axis][z] |= bits & -bits, any = true;
    }
  return any ? std::make_shared<const CellCuts>(cuts) : nullptr;
}

// Splits the tissue of one brick into pieces, the connected components of the tissue in each cell. For each piece, sums
// up the bone weights that its voxels give to the corners of the cell.
class Gather {
 public:
  Gather(const TissueVoxels& tissue, const SkinWeights& weights, int step, const glm::dvec3& spacing)
      : tissue_(tissue),
        weights_(weights),
        step_(step),
        spacing_(spacing),
        slot_of_(weights.bones().size(), -1) {}

  void add(std::int64_t brick_index, std::vector<CellPiece>& pieces) {
    const TissueVoxels::Brick& brick = tissue_.bricks()[brick_index];
    const auto first = std::ssize(pieces);
    const int side = TissueVoxels::kBrick / step_;
    const bool has_seams = tissue_.seams() && tissue_.seams()->is_near_brick(brick.corner);
    for (int c = 0; c < side * side * side; ++c) {
      const glm::ivec3 cell(c % side, c / side % side, c / (side * side)), low = cell * step_;
      Voxels left = voxels_of(brick, low, step_);
      const auto cuts = has_seams ? cuts_of(*tissue_.seams(), left, brick.corner + low) : nullptr;
      while (!is_empty(left)) {
        const Voxels piece = first_piece(left, cuts.get());
        for (int z = 0; z < 8; ++z) {
          left[z] &= ~piece[z];
          for (std::uint64_t bits = piece[z]; bits; bits &= bits - 1) {
            const int bit = std::countr_zero(bits);
            piece_of_[low.x + (bit & 7) + 8 * (low.y + (bit >> 3)) + 64 * (low.z + z)] =
                static_cast<std::uint16_t>(std::ssize(pieces) - first);
          }
        }
        pieces.push_back({brick.corner / step_ + cell, piece, 0, {}, {}, {}, cuts});
        pieces.back().away.fill(std::numeric_limits<float>::infinity());
      }
    }

    count_ = std::ssize(pieces) - first;
    sums_.clear();
    bones_.clear();
    auto influence = weights_.chunk(brick_index).begin();
    tissue_.for_each(brick_index, brick_index + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - brick.corner;
      const int piece = piece_of_[v.x + 8 * v.y + 64 * v.z];
      const Influence follows = *influence++;
      add(follows, piece, (glm::dvec3(v % step_) + 0.5) / double(step_));
      add(follows, pieces[first + piece], v % step_);
    });
    for (std::int64_t piece = 0; piece < count_; ++piece)
      for (size_t slot = 0; slot < bones_.size(); ++slot)
        for (int corner = 0; corner < 8; ++corner)
          if (const float sum = sums_[(slot * count_ + piece) * 8 + corner]; sum > 0)
            pieces[first + piece].shares.push_back({corner, bones_[slot], sum});
    for (const int bone : bones_) slot_of_[bone] = -1;
    for (std::int64_t piece = 0; piece < count_; ++piece) {
      auto& stiff = pieces[first + piece].stiff;
      std::sort(stiff.begin(), stiff.end(),
                [](const CellPiece::Stiff& a, const CellPiece::Stiff& b) { return a.bone < b.bone; });
    }
  }

 private:
  // Adds a voxel's bone weights to the eight corners of its cell, each multiplied by the corner's trilinear weight at
  // the voxel.
  //   t  position of the voxel in the cell, [0, 1]^3
  void add(const Influence& influence, std::int64_t piece, const glm::dvec3& t) {
    const double hold = influence.weight[0] == kFullWeight ? kHold : 1;
    for (int n = 0; n < 4 && influence.weight[n]; ++n) {
      int& slot = slot_of_[influence.bone[n]];
      if (slot < 0) {
        slot = static_cast<int>(bones_.size());
        bones_.push_back(influence.bone[n]);
        sums_.resize(sums_.size() + size_t(count_) * 8, 0);
      }
      float* sums = &sums_[(slot * count_ + piece) * 8];
      for (int i = 0; i < 8; ++i)
        sums[i] += static_cast<float>(hold * influence.weight[n] * (i & 1 ? t.x : 1 - t.x) * (i & 2 ? t.y : 1 - t.y) *
                                      (i & 4 ? t.z : 1 - t.z));
    }
  }

  // Adds a voxel to the members `places`, `away` and, if the voxel follows one bone with full weight, `stiff` of its
  // piece.
  //   voxel  position relative to the cell's lowest voxel
  void add(const Influence& influence, CellPiece& piece, const glm::ivec3& voxel) {
    const glm::ivec3 at = voxel * 4 / step_;
    const std::uint64_t place = std::uint64_t{1} << (at.x + 4 * (at.y + 4 * at.z));
    piece.places |= place;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 away =
          (glm::dvec3(voxel) + 0.5 - glm::dvec3(i & 1, i >> 1 & 1, i >> 2) * double(step_)) * spacing_;
      piece.away[i] = std::min(piece.away[i], static_cast<float>(glm::dot(away, away)));
    }
    if (influence.weight[0] != kFullWeight) return;
    for (CellPiece::Stiff& each : piece.stiff)
      if (each.bone == influence.bone[0]) {
        each.places |= place;
        return;
      }
    piece.stiff.push_back({influence.bone[0], place});
  }

  const TissueVoxels& tissue_;
  const SkinWeights& weights_;
  int step_;
  glm::dvec3 spacing_;
  std::int64_t count_ = 0;  // number of pieces in the current brick
  std::array<std::uint16_t, 512> piece_of_;
  std::vector<int> slot_of_, bones_;
  std::vector<float> sums_;
};

}  // namespace

std::vector<CellPiece> cell_pieces(const TissueVoxels& tissue, const SkinWeights& weights, int step,
                                   const glm::dvec3& spacing) {
  std::vector<std::int64_t> every(tissue.bricks().size());
  std::iota(every.begin(), every.end(), 0);
  return cell_pieces(tissue, weights, step, spacing, every);
}

std::vector<CellPiece> cell_pieces(const TissueVoxels& tissue, const SkinWeights& weights, int step,
                                   const glm::dvec3& spacing, std::span<const std::int64_t> bricks) {
  std::vector<std::vector<CellPiece>> blocks((bricks.size() + kGrain - 1) / kGrain);
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Gather gather(tissue, weights, step, spacing);
    for (auto i = begin; i < end; ++i) gather.add(bricks[i], blocks[begin / kGrain]);
  });
  std::vector<CellPiece> pieces;
  for (auto& block : blocks)
    pieces.insert(pieces.end(), std::make_move_iterator(block.begin()), std::make_move_iterator(block.end()));
  return pieces;
}

bool touch(const CellPiece& a, const CellPiece& b, int axis, int step) {
  const auto open = [&](int z) { return a.voxels[z] & (a.cuts ? ~(*a.cuts)[axis][z] : ~std::uint64_t{0}); };
  if (axis == 2) return (open(step - 1) & b.voxels[0]) != 0;
  const int shift = axis == 0 ? step - 1 : 8 * (step - 1);
  const std::uint64_t first = axis == 0 ? kFirstColumn : 0xff;
  for (int z = 0; z < step; ++z)
    if (open(z) >> shift & b.voxels[z] & first) return true;
  return false;
}

PiecesByCell::PiecesByCell(const std::vector<CellPiece>& pieces, const glm::ivec3& first, const glm::ivec3& size)
    : pieces_(&pieces),
      first_(first),
      size_(size),
      begin_(size_t(size.x) * size.y * size.z, -1) {
  for (size_t i = pieces.size(); i-- > 0;) {
    const glm::ivec3 c = pieces[i].cell - first;
    begin_[c.x + std::int64_t{size.x} * (c.y + std::int64_t{size.y} * c.z)] = static_cast<std::int32_t>(i);
  }
}

std::span<const CellPiece> PiecesByCell::of(const glm::ivec3& cell) const {
  const glm::ivec3 c = cell - first_;
  if (glm::any(glm::lessThan(c, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(c, size_))) return {};
  const std::int32_t begin = begin_[c.x + std::int64_t{size_.x} * (c.y + std::int64_t{size_.y} * c.z)];
  if (begin < 0) return {};
  size_t end = begin;
  while (end < pieces_->size() && (*pieces_)[end].cell == cell) ++end;
  return {pieces_->data() + begin, pieces_->data() + end};
}

}  // namespace limber
